#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/decimal.h"
#include "base/memory.h"

enum {
    BUFFER_SIZE = 64 * 1024,
    LINKS_MOST = 40,        /* symbolic links followed, as the kernel does */
    TEMPORARIES_MOST = 1000 /* names tried for the temporary file */
};

static bcifs_status file_report(struct file *file, int failure)
{
    char words[128] = "";
    if (failure == ENOMEM)
        return report_memory(file->report);
    if (strerror_r(failure, words, sizeof words) != 0 || !words[0])
        snprintf(words, sizeof words, "error %d", failure);
    const char *name = strcmp(file->name, "-") == 0 ? "the standard output" : file->name;
    const char *quote = name == file->name ? "'" : "";
    return report_failure(file->report, BCIFS_SYSTEM, NULL, "cannot write %s%s%s: %s", quote, name, quote,
                          words);
}

/* ---- Finding the place --------------------------------------------------------------------------------- */

/* Length of the directory part of a path, its slash included. */
static size_t directory_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The directory of `path` followed by `name`, or just `name` when that is absolute. NULL: no memory. */
static char *path_beside(const char *path, const char *name)
{
    size_t directory = name[0] == '/' ? 0 : directory_length(path), length = strlen(name);
    char *joined = memory_new(directory + length + 1, 1);
    if (joined) {
        memcpy(joined, path, directory);
        memcpy(joined + directory, name, length);
    }
    return joined;
}

/* Replaces *path by what the symbolic link it names points to. Returns 1 when it did, 0 when *path is no
 * link, or -1 with errno. */
static int link_follow(char **path)
{
    struct stat status;
    if (lstat(*path, &status) != 0)
        return errno == ENOENT ? 0 : -1;
    if (!S_ISLNK(status.st_mode))
        return 0;
    char content[4096];
    ssize_t length = readlink(*path, content, sizeof content - 1);
    if (length < 0)
        return -1;
    content[length] = '\0';
    char *next = path_beside(*path, content);
    if (!next) {
        errno = ENOMEM;
        return -1;
    }
    memory_free(*path);
    *path = next;
    return 1;
}

/* The file that a path finally names, through links; it need not exist. NULL with errno on failure. */
static char *path_resolve(const char *path)
{
    size_t length = strlen(path);
    char *resolved = memory_new(length + 1, 1);
    if (!resolved) {
        errno = ENOMEM;
        return NULL;
    }
    memcpy(resolved, path, length);
    for (int links = 0; links < LINKS_MOST; links++) {
        int followed = link_follow(&resolved);
        if (followed == 0)
            return resolved;
        if (followed < 0) {
            int failure = errno;
            memory_free(resolved);
            errno = failure;
            return NULL;
        }
    }
    memory_free(resolved);
    errno = ELOOP;
    return NULL;
}

/* ---- Opening ------------------------------------------------------------------------------------------- */

/* Opens a file that nobody else has in the target's directory. The name does not contain the target's, which
 * may be as long as names can be. Returns 0 or an errno. */
static int temporary_open(struct file *file)
{
    for (int number = 0; number < TEMPORARIES_MOST; number++) {
        char name[64];
        snprintf(name, sizeof name, ".bcifs-%ld-%d.tmp", (long)getpid(), number);
        memory_free(file->temporary);
        file->temporary = path_beside(file->target, name);
        if (!file->temporary)
            return ENOMEM;
        do
            file->descriptor = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        while (file->descriptor < 0 && errno == EINTR);
        if (file->descriptor >= 0)
            return 0;
        if (errno != EEXIST)
            return errno;
    }
    return EEXIST;
}

/* `existing` is what stands in the file's place, or NULL. Returns 0 or an errno. */
static int replacement_open(struct file *file, const struct stat *existing)
{
    /* A file that its owner protected is not to be replaced, though a rename would succeed. */
    if (existing && faccessat(AT_FDCWD, file->name, W_OK, AT_EACCESS) != 0)
        return errno;
    file->target = path_resolve(file->name);
    if (!file->target)
        return errno;
    int failure = temporary_open(file);
    if (failure)
        return failure;
    if (existing && fchmod(file->descriptor, existing->st_mode & 0777) != 0)
        return errno;
    return 0;
}

/* Standard output is duplicated, so that closing it is checked too. */
static int standard_output_open(struct file *file)
{
    file->descriptor = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    return file->descriptor < 0 ? errno : 0;
}

static int device_open(struct file *file)
{
    do
        file->descriptor = open(file->name, O_WRONLY | O_NOCTTY | O_CLOEXEC);
    while (file->descriptor < 0 && errno == EINTR);
    return file->descriptor < 0 ? errno : 0;
}

/* Returns 0 or an errno. */
static int descriptor_open(struct file *file)
{
    struct stat existing, output;
    if (strcmp(file->name, "-") == 0)
        return standard_output_open(file);
    if (file->name[0] == '\0')
        return ENOENT;
    if (stat(file->name, &existing) != 0)
        return errno == ENOENT ? replacement_open(file, NULL) : errno;
    if (S_ISDIR(existing.st_mode))
        return EISDIR;
    /* /dev/stdout redirected to a file must not replace that file under the one who writes to it. */
    if (fstat(STDOUT_FILENO, &output) == 0 && output.st_dev == existing.st_dev &&
        output.st_ino == existing.st_ino)
        return standard_output_open(file);
    return S_ISREG(existing.st_mode) ? replacement_open(file, &existing) : device_open(file);
}

static void file_free(struct file *file)
{
    memory_free(file->target);
    memory_free(file->temporary);
    memory_free(file->buffer);
    file->target = file->temporary = NULL;
    file->buffer = NULL;
}

static void file_remove(struct file *file)
{
    if (file->descriptor >= 0) {
        close(file->descriptor);
        if (file->target)
            unlink(file->temporary);
    }
    file->descriptor = -1;
    file_free(file);
}

bcifs_status file_open(struct file *file, const char *path, struct report *report)
{
    *file = (struct file){.report = report, .name = path, .descriptor = -1};
    file->buffer = memory_new(BUFFER_SIZE, 1);
    if (!file->buffer)
        return report_memory(report);
    int failure = descriptor_open(file);
    if (failure) {
        file_remove(file);
        return file_report(file, failure);
    }
    return BCIFS_OK;
}

/* ---- Writing ------------------------------------------------------------------------------------------- */

/* Hands bytes to the system, however many calls that takes. */
static void descriptor_write(struct file *file, const unsigned char *bytes, size_t length)
{
    while (length > 0 && !file->failure) {
        ssize_t written = write(file->descriptor, bytes, length);
        if (written > 0) {
            bytes += written;
            length -= (size_t)written;
        } else if (written == 0) {
            file->failure = EIO;
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            /* A pipe that its other end made non-blocking. */
            struct pollfd ready = {.fd = file->descriptor, .events = POLLOUT};
            poll(&ready, 1, -1);
        } else if (errno != EINTR) {
            file->failure = errno;
        }
    }
}

static void file_flush(struct file *file)
{
    descriptor_write(file, file->buffer, file->used);
    file->used = 0;
}

void file_write(struct file *file, const void *bytes, size_t length)
{
    if (length > BUFFER_SIZE - file->used)
        file_flush(file);
    if (length >= BUFFER_SIZE) {
        descriptor_write(file, bytes, length);
    } else if (length > 0) {
        memcpy(file->buffer + file->used, bytes, length);
        file->used += length;
    }
}

void file_text(struct file *file, const char *text)
{
    file_write(file, text, strlen(text));
}

void file_integer(struct file *file, uint64_t number)
{
    char digits[20];
    size_t first = sizeof digits;
    do {
        digits[--first] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    file_write(file, digits + first, sizeof digits - first);
}

void file_number(struct file *file, double number)
{
    char digits[DECIMAL_LONGEST];
    file_write(file, digits, decimal_print(digits, number));
}

void file_fixed(struct file *file, double number, int decimals)
{
    char digits[DECIMAL_LONGEST];
    file_write(file, digits, decimal_print_fixed(digits, number, decimals));
}

bool file_failed(const struct file *file)
{
    return file->failure != 0;
}

bcifs_status file_close(struct file *file, bcifs_status status)
{
    if (status == BCIFS_OK)
        file_flush(file);
    int failure = file->failure;
    if (status == BCIFS_OK && !failure) {
        /* The descriptor is gone after close, even when that was interrupted. */
        if (close(file->descriptor) != 0 && errno != EINTR)
            failure = errno;
        if (!failure && file->target && rename(file->temporary, file->target) != 0)
            failure = errno;
        if (failure && file->target)
            unlink(file->temporary);
        file->descriptor = -1;
    }
    file_remove(file);
    return status == BCIFS_OK && failure ? file_report(file, failure) : status;
}
