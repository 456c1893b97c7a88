/* Things described in one word of a command line: "NAME key=number key=number …". */
#ifndef SCREE_CLI_WORDS_H
#define SCREE_CLI_WORDS_H

#include "contact/encounter.h"

enum { WORDS_SETTINGS = 16, WORDS_LENGTH = 512 };

struct words {
    char text[WORDS_LENGTH]; /* what the names below point into, those of a copy too: the original must outlive it */
    const char *name;
    int settings;
    scree_setting setting[WORDS_SETTINGS];
};

/* Split `text`, given with `option`; spaces and commas separate. SCREE_BAD_INPUT says what was expected. */
scree_status words_read(struct words *words, const char *text, const char *option, scree_trouble *trouble);

/* Copy with one number set anew, or added. */
scree_status words_with(const struct words *words, const char *key, double value, struct words *changed,
                        scree_trouble *trouble);

/* As a law and its parameters; the strings stay those of `words`. */
scree_status words_law(const struct words *words, scree_law_choice *choice, scree_trouble *trouble);

/* A body: shape, mass, attitude, and what it is made of. */
struct words_body {
    scree_shape shape;
    double mass; /* kg; 0: never moves */
    struct quat attitude;
    double young, poisson; /* Pa (0: not said; HUGE_VAL: rigid), 1 */
};

/* "sphere radius= …", "box x= y= z= …", "plane …"; what each takes stands in the help of `scree impact`. */
scree_status words_body(const struct words *words, const char *option, struct words_body *body, scree_trouble *trouble);

#endif
