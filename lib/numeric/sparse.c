#include "sparse.h"

#include <stdlib.h>
#include <string.h>

/* A matrix that is being filled: the same arrays, not yet constant. */
struct entries {
    size_t *starts;
    uint32_t *columns;
    double *values;
};

static bool entries_new(struct entries *entries, size_t rows, size_t count, struct arena *arena)
{
    entries->starts = arena_new(arena, rows + 1, sizeof *entries->starts);
    entries->columns = arena_new(arena, count, sizeof *entries->columns);
    entries->values = arena_new(arena, count, sizeof *entries->values);
    return entries->starts && entries->columns && entries->values;
}

static struct sparse sparse_of(const struct entries *entries, size_t rows, size_t width)
{
    return (struct sparse){rows, width, entries->starts, entries->columns, entries->values};
}

/* Counts, count of i at [i + 1], become starts. */
static void sum_up(size_t *starts, size_t count)
{
    for (size_t i = 0; i < count; i++)
        starts[i + 1] += starts[i];
}

/* ---- Making -------------------------------------------------------------------------------------------- */

/* Entries of rows that may hold a column twice, adjacent: they add up; zeros go. Works in place. */
static void entries_merge(struct entries *entries, size_t rows)
{
    size_t from = 0, to = 0;
    for (size_t i = 0; i < rows; i++) {
        size_t end = entries->starts[i + 1];
        entries->starts[i] = to;
        while (from < end) {
            uint32_t column = entries->columns[from];
            double sum = 0;
            for (; from < end && entries->columns[from] == column; from++)
                sum += entries->values[from];
            if (sum != 0) {
                entries->columns[to] = column;
                entries->values[to++] = sum;
            }
        }
    }
    entries->starts[rows] = to;
}

/* Triples by column (two stable passes of counting sort sort them by row, then column): `by_column` their
 * indices. */
static void sort_by_column(const struct triple *triples, size_t count, size_t *starts, size_t width,
                           size_t *by_column)
{
    for (size_t k = 0; k < count; k++)
        starts[triples[k].column + 1]++;
    sum_up(starts, width);
    for (size_t k = 0; k < count; k++)
        by_column[starts[triples[k].column]++] = k;
}

bool sparse_from_triples(struct sparse *a, size_t rows, size_t width, const struct triple *triples,
                         size_t count, struct arena *arena)
{
    struct entries entries;
    size_t *starts = memory_new(width + 1, sizeof *starts);
    size_t *by_column = memory_new(count, sizeof *by_column);
    size_t *next = memory_new(rows + 1, sizeof *next);
    bool made = starts && by_column && next && entries_new(&entries, rows, count, arena);
    if (made) {
        sort_by_column(triples, count, starts, width, by_column);
        for (size_t k = 0; k < count; k++)
            next[triples[k].row + 1]++;
        sum_up(next, rows);
        memcpy(entries.starts, next, (rows + 1) * sizeof *next);
        for (size_t k = 0; k < count; k++) {
            const struct triple *triple = &triples[by_column[k]];
            size_t place = next[triple->row]++;
            entries.columns[place] = (uint32_t)triple->column;
            entries.values[place] = triple->value;
        }
        entries_merge(&entries, rows);
        *a = sparse_of(&entries, rows, width);
    }
    memory_free(starts);
    memory_free(by_column);
    memory_free(next);
    return made;
}

bool sparse_transpose(const struct sparse *a, struct sparse *b, struct arena *arena)
{
    struct entries entries;
    if (!entries_new(&entries, a->width, a->starts[a->rows], arena))
        return false;
    for (size_t k = 0; k < a->starts[a->rows]; k++)
        entries.starts[a->columns[k] + 1]++;
    sum_up(entries.starts, a->width);
    /* Filling row j moves its start to its end, which is the start of j + 1: all move back by one afterwards.
     */
    for (size_t i = 0; i < a->rows; i++)
        for (size_t k = a->starts[i]; k < a->starts[i + 1]; k++) {
            size_t place = entries.starts[a->columns[k]]++;
            entries.columns[place] = (uint32_t)i;
            entries.values[place] = a->values[k];
        }
    memmove(entries.starts + 1, entries.starts, a->width * sizeof *entries.starts);
    entries.starts[0] = 0;
    *b = sparse_of(&entries, a->width, a->rows);
    return true;
}

/* ---- Products ------------------------------------------------------------------------------------------ */

static int column_compare(const void *left, const void *right)
{
    uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    return (a > b) - (a < b);
}

/* Rows of products are short: insertion beats the library's sort there. */
static void columns_sort(uint32_t *columns, size_t count)
{
    enum { SHORT = 32 };
    if (count > SHORT) {
        qsort(columns, count, sizeof *columns, column_compare);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint32_t column = columns[i];
        size_t place = i;
        for (; place > 0 && columns[place - 1] > column; place--)
            columns[place] = columns[place - 1];
        columns[place] = column;
    }
}

/* The columns of row i of A·B, in the order they are met: returns how many. `seen` (B's width) holds i + 1
 * for those met in row i; `columns` may be NULL. */
static size_t product_columns(const struct sparse *a, const struct sparse *b, size_t i, size_t *seen,
                              uint32_t *columns)
{
    size_t count = 0;
    for (size_t k = a->starts[i]; k < a->starts[i + 1]; k++) {
        size_t row = a->columns[k];
        for (size_t l = b->starts[row]; l < b->starts[row + 1]; l++)
            if (seen[b->columns[l]] != i + 1) {
                seen[b->columns[l]] = i + 1;
                if (columns)
                    columns[count] = b->columns[l];
                count++;
            }
    }
    return count;
}

/* c_i = Σ_k a_ik b_k, row after row (Gustavson 1978), into `sums` (B's width, zero before and after). */
static void product_fill(const struct sparse *a, const struct sparse *b, size_t *seen, double *sums,
                         struct entries *c)
{
    for (size_t i = 0; i < a->rows; i++) {
        uint32_t *columns = c->columns + c->starts[i];
        double *values = c->values + c->starts[i];
        size_t count = product_columns(a, b, i, seen, columns);
        columns_sort(columns, count);
        for (size_t k = a->starts[i]; k < a->starts[i + 1]; k++) {
            size_t row = a->columns[k];
            for (size_t l = b->starts[row]; l < b->starts[row + 1]; l++)
                sums[b->columns[l]] += a->values[k] * b->values[l];
        }
        for (size_t k = 0; k < count; k++) {
            values[k] = sums[columns[k]];
            sums[columns[k]] = 0;
        }
    }
}

bool sparse_multiply(const struct sparse *a, const struct sparse *b, struct sparse *c, struct arena *arena)
{
    struct entries entries;
    size_t *seen = memory_new(b->width, sizeof *seen);
    double *sums = memory_new(b->width, sizeof *sums);
    bool made = seen && sums;
    size_t total = 0;
    for (size_t i = 0; made && i < a->rows; i++)
        total += product_columns(a, b, i, seen, NULL);
    made = made && entries_new(&entries, a->rows, total, arena);
    if (made) {
        memset(seen, 0, b->width * sizeof *seen);
        for (size_t i = 0; i < a->rows; i++)
            entries.starts[i + 1] = entries.starts[i] + product_columns(a, b, i, seen, NULL);
        memset(seen, 0, b->width * sizeof *seen);
        product_fill(a, b, seen, sums, &entries);
        entries_merge(&entries, a->rows);
        *c = sparse_of(&entries, a->rows, b->width);
    }
    memory_free(seen);
    memory_free(sums);
    return made;
}

/* One component has no inner loop, two are the plane's coordinates; others are rare. */
void sparse_apply(const struct sparse *a, const double *x, size_t components, bool add, double *y)
{
    if (!add)
        memset(y, 0, a->rows * components * sizeof *y);
    for (size_t i = 0; i < a->rows; i++) {
        size_t start = a->starts[i], end = a->starts[i + 1];
        double *sum = y + i * components;
        if (components == 1) {
            double first = 0;
            for (size_t k = start; k < end; k++)
                first += a->values[k] * x[a->columns[k]];
            sum[0] += first;
        } else if (components == 2) {
            double first = 0, second = 0;
            for (size_t k = start; k < end; k++) {
                first += a->values[k] * x[2 * (size_t)a->columns[k]];
                second += a->values[k] * x[2 * (size_t)a->columns[k] + 1];
            }
            sum[0] += first;
            sum[1] += second;
        } else {
            for (size_t k = start; k < end; k++)
                for (size_t c = 0; c < components; c++)
                    sum[c] += a->values[k] * x[a->columns[k] * components + c];
        }
    }
}

/* ---- Parts --------------------------------------------------------------------------------------------- */

/* Rising indices and, when they are many, the place of each: a search of few costs less than a table of all.
 */
struct places {
    const size_t *list;
    size_t count;
    uint32_t *table; /* of each column: its place + 1, or 0; NULL: search the list */
};

static bool places_make(struct places *places, const size_t *list, size_t count, size_t width)
{
    enum { FEW = 16 };
    *places = (struct places){list, count, NULL};
    if (count < width / FEW)
        return true;
    places->table = memory_new(width, sizeof *places->table);
    for (size_t i = 0; places->table && i < count; i++)
        places->table[list[i]] = (uint32_t)i + 1;
    return places->table != NULL;
}

/* The place of `column` in the list + 1; 0 when it is not there. */
static size_t place_of(const struct places *places, size_t column)
{
    if (places->table)
        return places->table[column];
    size_t low = 0, high = places->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (places->list[middle] < column)
            low = middle + 1;
        else
            high = middle;
    }
    return low < places->count && places->list[low] == column ? low + 1 : 0;
}

bool sparse_select(const struct sparse *a, const size_t *rows, size_t row_count, const size_t *columns,
                   size_t column_count, struct sparse *b, struct arena *arena)
{
    struct entries entries;
    struct places places;
    size_t bound = 0, count = 0;
    for (size_t i = 0; i < row_count; i++)
        bound += a->starts[rows[i] + 1] - a->starts[rows[i]];
    if (!places_make(&places, columns, column_count, a->width) ||
        !entries_new(&entries, row_count, bound, arena)) {
        memory_free(places.table);
        return false;
    }
    for (size_t i = 0; i < row_count; i++) {
        for (size_t k = a->starts[rows[i]]; k < a->starts[rows[i] + 1]; k++) {
            size_t place = place_of(&places, a->columns[k]);
            if (place > 0) {
                entries.columns[count] = (uint32_t)(place - 1);
                entries.values[count++] = a->values[k];
            }
        }
        entries.starts[i + 1] = count;
    }
    *b = sparse_of(&entries, row_count, column_count);
    memory_free(places.table);
    return true;
}

double sparse_entry(const struct sparse *a, size_t row, size_t column)
{
    size_t low = a->starts[row], high = a->starts[row + 1];
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (a->columns[middle] < column)
            low = middle + 1;
        else
            high = middle;
    }
    return low < a->starts[row + 1] && a->columns[low] == column ? a->values[low] : 0;
}
