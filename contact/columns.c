/* What belongs to each contact of a batch lies in columns, and segments in these one behind the other. */
#include "contact/columns.h"

#include "bodies/memory.h"

#include <string.h>

int scree_enlarge(void *array, int before, int after, size_t size) {
    void **place = array, *memory = scree_memory((size_t)after * size);
    if (!memory) return 0;
    if (before) memcpy(memory, *place, (size_t)before * size);
    scree_memory_free(*place);
    *place = memory;
    return 1;
}

scree_status scree_make_space(struct scree_space *space, size_t size, scree_trouble *trouble) {
    if (space->memory && size <= space->size) return SCREE_OK;
    size_t room = size + size / 16 + 64; /* never none: places in it are reckoned from its beginning */
    void *memory = scree_memory(room);
    if (!memory) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for lists of %zu bytes", room);
    scree_memory_free(space->memory);
    *space = (struct scree_space){memory, room};
    return SCREE_OK;
}

int scree_columns_of(const struct scree_batch *batch, struct scree_column column[SCREE_MOST_COLUMNS]) {
    int count = 0;
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->kept[m]) column[count++] = (struct scree_column){(unsigned char *)batch->kept[m], sizeof(double)};
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
        column[count++] = (struct scree_column){(unsigned char *)batch->past[m], sizeof(double)};
    if (batch->slides) column[count++] = (struct scree_column){batch->slides, 1};
    return count;
}

scree_status scree_enlarge_batch(struct scree_batch *batch, int capacity, scree_trouble *trouble) {
    int before = batch->capacity, ok = 1;
    int cornered = batch->corners && !batch->corner;
    if (capacity < before) capacity = before;
    if (cornered && capacity) ok &= scree_enlarge(&batch->corner, 0, capacity, sizeof *batch->corner);
    if (ok && capacity == before) return SCREE_OK;
    if (batch->corner && !cornered) ok &= scree_enlarge(&batch->corner, before, capacity, sizeof *batch->corner);
    ok &= scree_enlarge(&batch->ends, before, capacity, sizeof *batch->ends);
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->keeps[m] && m != SCREE_KEPT_STATE)
            ok &= scree_enlarge(&batch->kept[m], before, capacity, sizeof(double));
    if (batch->keeps[SCREE_KEPT_STATE]) ok &= scree_enlarge(&batch->slides, before, capacity, 1);
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
        ok &= scree_enlarge(&batch->past[m], before, capacity, sizeof(double));
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts", capacity);
    batch->capacity = capacity;
    return SCREE_OK;
}

scree_status scree_enlarge_yield(struct scree_batch *batch, scree_trouble *trouble) {
    int blocks = (batch->segment[0].count + SCREE_LANES - 1) / SCREE_LANES, ok = 1;
    if (blocks <= batch->blocks) return SCREE_OK;
    blocks += blocks / 2;
    ok &= scree_enlarge(&batch->yield, batch->blocks, blocks, sizeof *batch->yield);
    if (batch->impulses) ok &= scree_enlarge(&batch->moments, batch->blocks, blocks, sizeof *batch->moments);
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for the yield of %d contacts", blocks);
    batch->blocks = blocks;
    return SCREE_OK;
}

/* Those that name the contacts. */
static int names_of(const struct scree_batch *batch, struct scree_column column[2]) {
    column[0] = (struct scree_column){(unsigned char *)batch->ends, sizeof *batch->ends};
    if (batch->corner) column[1] = (struct scree_column){(unsigned char *)batch->corner, sizeof *batch->corner};
    return batch->corner ? 2 : 1;
}

int scree_all_columns_of(const struct scree_batch *batch, struct scree_column column[SCREE_ALL_COLUMNS]) {
    int count = scree_columns_of(batch, column);
    return count + names_of(batch, column + count);
}

void scree_shift_segment(struct scree_batch *batch, struct scree_part *segment, int to) {
    struct scree_column column[SCREE_ALL_COLUMNS];
    int columns = scree_all_columns_of(batch, column), count = segment->count;
    for (int c = 0; c < columns && to != segment->first && count; c++)
        memmove(scree_column_at(column[c], to), scree_column_at(column[c], segment->first),
                (size_t)count * column[c].size);
    segment->first = to;
}

void scree_clear_padding(struct scree_batch *batch, const struct scree_part *segment) {
    struct scree_column column[SCREE_MOST_COLUMNS];
    int columns = scree_columns_of(batch, column), count = segment->count;
    for (int c = 0; c < columns && count; c++)
        memset(scree_column_at(column[c], segment->first + count), 0,
               (size_t)(scree_padded(count) - count) * column[c].size);
}

scree_status scree_lay_out(struct scree_batch *batch, int segments, const int *capacity, scree_trouble *trouble) {
    int all = 0, first[SCREE_SEGMENTS], used = 0;
    for (int s = 0; s < segments; s++) {
        first[s] = all;
        all += capacity[s];
    }
    scree_status status = scree_enlarge_batch(batch, all, trouble);
    if (status) return status;
    for (int s = 0; s < segments; s++) { /* close the gaps, then open new ones from the end */
        scree_shift_segment(batch, &batch->segment[s], used);
        used += batch->segment[s].count;
    }
    for (int s = segments - 1; s >= 0; s--) {
        scree_shift_segment(batch, &batch->segment[s], first[s]);
        batch->segment[s].capacity = capacity[s];
        scree_clear_padding(batch, &batch->segment[s]);
    }
    return SCREE_OK;
}
