/* Columns of a batch (columns.c): between the files that make lists, move contacts in them, or put them in order. */
#ifndef SCREE_CONTACT_COLUMNS_H
#define SCREE_CONTACT_COLUMNS_H

#include "contact/contacts.h"

/* A column of a batch that belongs to its contacts: numbers, or bytes. */
struct scree_column {
    unsigned char *at;
    size_t size; /* of each */
};

static inline void *scree_column_at(struct scree_column column, int k) { return column.at + (size_t)k * column.size; }

/* The columns of what is kept of contacts; and all of them, with those that name the contacts. Both return how many.
 * Pair constants are apart: they are made after the contacts are in their places (list.c). */
enum { SCREE_MOST_COLUMNS = SCREE_MEMORY + SCREE_PAST, SCREE_ALL_COLUMNS = SCREE_MOST_COLUMNS + 2 };
int scree_columns_of(const struct scree_batch *batch, struct scree_column column[SCREE_MOST_COLUMNS]);
int scree_all_columns_of(const struct scree_batch *batch, struct scree_column column[SCREE_ALL_COLUMNS]);

/* Room for so many contacts, or as many as before; with corners, if the batch has got some. SCREE_NO_MEMORY: all is as
 * it was. */
scree_status scree_enlarge_batch(struct scree_batch *batch, int capacity, scree_trouble *trouble);

/* Room for what the blocks of segment 0 yield. */
scree_status scree_enlarge_yield(struct scree_batch *batch, scree_trouble *trouble);

/* Move a segment's contacts and columns to another place. */
void scree_shift_segment(struct scree_batch *batch, struct scree_part *segment, int to);

/* What columns hold behind a segment's last contact, up to whole vectors, becomes zero. */
void scree_clear_padding(struct scree_batch *batch, const struct scree_part *segment);

/* Give the segments of a batch the capacities wanted (contacts, none below what the segment holds), in the order of
 * segments. SCREE_NO_MEMORY: all is as it was. */
scree_status scree_lay_out(struct scree_batch *batch, int segments, const int *capacity, scree_trouble *trouble);

#endif
