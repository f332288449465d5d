/* The promises of lib/output/file: whole or not at all, modes, links, and the words for the system's
 * failures. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "sample.h"
#include "tap.h"

static bcifs_error failure;

/* Writes `length` bytes of a pattern in pieces of growing size, and hands `fate` to file_close. */
static bcifs_status pattern_write(const char *path, size_t length, bcifs_status fate)
{
    struct report report = report_new(NULL);
    struct file file;
    if (file_open(&file, path, &report) == BCIFS_OK) {
        char *bytes = malloc(length + 1);
        for (size_t i = 0; i < length; i++)
            bytes[i] = (char)('a' + i * i % 23);
        for (size_t done = 0, piece = 1; done < length; done += piece, piece = 3 * piece + 1) {
            piece = piece < length - done ? piece : length - done;
            file_write(&file, bytes + done, piece);
        }
        free(bytes);
        if (fate != BCIFS_OK)
            report_failure(&report, fate, NULL, "the points are bad");
        file_close(&file, fate);
    }
    return report_close(&report, &failure);
}

static bool pattern_stands(const char *path, size_t length)
{
    size_t read;
    char *bytes = sample_read(path, &read);
    bool same = bytes && read == length;
    for (size_t i = 0; same && i < length; i++)
        same = bytes[i] == (char)('a' + i * i % 23);
    free(bytes);
    return same;
}

static unsigned mode_of(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0 ? (unsigned)status.st_mode & 07777 : 0;
}

static bool is_link(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0 && S_ISLNK(status.st_mode);
}

/* The failure is the system's, in errno's words, and quotes the path. */
static bool failed_with(const char *path, int number)
{
    char quoted[256];
    snprintf(quoted, sizeof quoted, "'%s'", path);
    bool good = failure.status == BCIFS_SYSTEM && strstr(failure.message, quoted) &&
                strstr(failure.message, strerror(number));
    if (!good)
        note("%d %s", failure.status, failure.message);
    return good;
}

static void test_success(void)
{
    static const size_t lengths[] = {0, 1, 65535, 65536, 65537, 1000000};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        ok(pattern_write("new", lengths[i], BCIFS_OK) == BCIFS_OK, "%zu bytes are written", lengths[i]);
        ok(pattern_stands("new", lengths[i]), "and read back");
    }
    ok(sample_directory_count() == 1, "nothing else is left");
    remove("new");
    umask(027);
    pattern_write("new", 10, BCIFS_OK);
    ok(mode_of("new") == 0640, "a new file obeys the umask: %o", mode_of("new"));
    umask(022);
    chmod("new", 0604);
    pattern_write("new", 20, BCIFS_OK);
    ok(mode_of("new") == 0604 && pattern_stands("new", 20), "a replaced file keeps its mode: %o",
       mode_of("new"));
    remove("new");
}

static void test_links(void)
{
    mkdir("inner", 0755);
    ok(symlink("inner/target", "link") == 0 && symlink("link", "link2") == 0, "links are made");
    ok(pattern_write("link2", 10, BCIFS_OK) == BCIFS_OK && pattern_stands("inner/target", 10),
       "a dangling link leads to a new file");
    ok(pattern_write("link2", 20, BCIFS_OK) == BCIFS_OK && pattern_stands("inner/target", 20),
       "an existing target is replaced");
    ok(is_link("link") && is_link("link2"), "links stay links");
    ok(symlink("loop", "loop") == 0 && pattern_write("loop", 1, BCIFS_OK) == BCIFS_SYSTEM &&
           failed_with("loop", ELOOP),
       "a loop of links is an error");
    remove("inner/target");
    remove("inner");
    remove("link");
    remove("link2");
    remove("loop");
}

static void test_no_place(void)
{
    pattern_write("plain", 5, BCIFS_OK);
    mkdir("directory", 0755);
    pattern_write("missing/file", 5, BCIFS_OK);
    ok(failed_with("missing/file", ENOENT), "a missing directory");
    pattern_write("", 5, BCIFS_OK);
    ok(failed_with("", ENOENT), "an empty path");
    pattern_write("plain/file", 5, BCIFS_OK);
    ok(failed_with("plain/file", ENOTDIR), "a file where a directory should be");
    pattern_write("directory", 5, BCIFS_OK);
    ok(failed_with("directory", EISDIR), "a directory where a file should be");
    if (geteuid() != 0) {
        chmod("directory", 0555);
        pattern_write("directory/file", 5, BCIFS_OK);
        ok(failed_with("directory/file", EACCES), "a directory without permission");
        chmod("plain", 0444);
        pattern_write("plain", 9, BCIFS_OK);
        ok(failed_with("plain", EACCES) && pattern_stands("plain", 5), "a file that is protected stays");
    }
    ok(sample_directory_count() == 2, "nothing is left behind");
    remove("plain");
    remove("directory");
}

static void test_nothing_half(void)
{
    pattern_write("before", 5, BCIFS_OK);
    ok(pattern_write("before", 200000, BCIFS_INPUT) == BCIFS_INPUT && strstr(failure.message, "bad"),
       "the writer's own failure is what is reported");
    ok(pattern_stands("before", 5) && sample_directory_count() == 1, "the file before is untouched");
    ok(pattern_write("fresh", 200000, BCIFS_MEMORY) == BCIFS_MEMORY && sample_directory_count() == 1,
       "a new file does not appear");
    struct rlimit all, little = {100000, 100000};
    getrlimit(RLIMIT_FSIZE, &all);
    little.rlim_max = all.rlim_max;
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &little);
    pattern_write("before", 200000, BCIFS_OK);
    setrlimit(RLIMIT_FSIZE, &all);
    ok(failed_with("before", EFBIG), "a file that may not grow");
    ok(pattern_stands("before", 5) && sample_directory_count() == 1, "the file before is untouched");
    remove("before");
}

static void test_temporary_taken(void)
{
    char name[64];
    snprintf(name, sizeof name, ".bcifs-%ld-0.tmp", (long)getpid());
    FILE *other = fopen(name, "w");
    fputs("mine", other);
    fclose(other);
    ok(pattern_write("new", 100, BCIFS_OK) == BCIFS_OK && pattern_stands("new", 100),
       "another's temporary file");
    size_t length;
    char *text = sample_read(name, &length);
    ok(text && strcmp(text, "mine") == 0, "is not touched");
    free(text);
    remove(name);
    char longest[256];
    memset(longest, 'n', 255);
    longest[255] = '\0';
    ok(pattern_write(longest, 100, BCIFS_OK) == BCIFS_OK && pattern_stands(longest, 100), "the longest name");
    remove(longest);
    remove("new");
}

static void test_devices(void)
{
    ok(pattern_write("/dev/null", 100000, BCIFS_OK) == BCIFS_OK, "/dev/null takes everything");
    if (access("/dev/full", W_OK) == 0) {
        pattern_write("/dev/full", 10, BCIFS_OK);
        ok(failed_with("/dev/full", ENOSPC), "a full device, found when closing");
        pattern_write("/dev/full", 1000000, BCIFS_OK);
        ok(failed_with("/dev/full", ENOSPC), "a full device, found when writing");
    }
    signal(SIGPIPE, SIG_IGN);
    ok(mkfifo("pipe", 0600) == 0, "a pipe is made");
    int reader = open("pipe", O_RDONLY | O_NONBLOCK);
    char bytes[101] = "";
    ok(pattern_write("pipe", 100, BCIFS_OK) == BCIFS_OK && read(reader, bytes, 101) == 100 && bytes[0] == 'a',
       "a pipe gets the bytes");
    struct report report = report_new(NULL);
    struct file file;
    ok(file_open(&file, "pipe", &report) == BCIFS_OK, "a pipe opens");
    close(reader);
    file_text(&file, "lost");
    ok(file_close(&file, BCIFS_OK) == BCIFS_SYSTEM, "a pipe that nobody reads is a failure");
    report_close(&report, &failure);
    ok(failed_with("pipe", EPIPE), "in the system's words");
    ok(sample_directory_count() == 1, "the pipe is still there, and nothing else");
    remove("pipe");
}

static void test_standard_output(void)
{
    fflush(stdout);
    int saved = dup(STDOUT_FILENO), capture = open("captured", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(capture, STDOUT_FILENO);
    bcifs_status to_dash = pattern_write("-", 70000, BCIFS_OK);
    bool dash = pattern_stands("captured", 70000);
    if (ftruncate(capture, 0) != 0 || lseek(capture, 0, SEEK_SET) != 0)
        dash = false;
    bcifs_status to_device = pattern_write("/dev/stdout", 30, BCIFS_OK);
    struct stat open_file, named;
    bool same =
        fstat(capture, &open_file) == 0 && stat("captured", &named) == 0 && open_file.st_ino == named.st_ino;
    close(STDOUT_FILENO);
    bcifs_status to_none = pattern_write("-", 30, BCIFS_OK);
    dup2(saved, STDOUT_FILENO);
    close(saved);
    close(capture);
    ok(to_dash == BCIFS_OK && dash, "- is the standard output");
    ok(to_device == BCIFS_OK && same, "/dev/stdout does not replace the file that the output goes to");
    ok(to_none == BCIFS_SYSTEM && strstr(failure.message, "standard output"),
       "a closed output is an error: %s", failure.message);
    remove("captured");
}

static void test_numbers(void)
{
    struct report report = report_new(NULL);
    struct file file;
    file_open(&file, "numbers", &report);
    file_integer(&file, 0);
    file_text(&file, " ");
    file_integer(&file, UINT64_MAX);
    file_text(&file, " ");
    file_number(&file, 0.1);
    file_text(&file, " ");
    file_fixed(&file, -12.345, 1);
    file_close(&file, BCIFS_OK);
    size_t length;
    char *text = sample_read("numbers", &length);
    ok(text && strcmp(text, "0 18446744073709551615 0.1 -12.3") == 0, "numbers: %s", text ? text : "");
    free(text);
    ok(bcifs_write_text("numbers", "abc", 3, NULL) == BCIFS_OK, "the public call");
    text = sample_read("numbers", &length);
    ok(text && strcmp(text, "abc") == 0, "writes text");
    free(text);
    ok(bcifs_write_text("no/where", "abc", 3, &failure) == BCIFS_SYSTEM && failed_with("no/where", ENOENT),
       "and says why it cannot");
    remove("numbers");
}

int main(void)
{
    char directory[64];
    sample_directory_enter(directory);
    umask(022);
    test_success();
    test_links();
    test_no_place();
    test_nothing_half();
    test_temporary_taken();
    test_devices();
    test_standard_output();
    test_numbers();
    ok(sample_directory_count() == 0, "the directory is as it was");
    sample_directory_remove(directory);
    return done_testing();
}
