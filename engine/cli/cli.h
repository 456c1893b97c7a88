/* The program's own conventions: subcommands, options, exit codes. */
#ifndef SCREE_CLI_H
#define SCREE_CLI_H

#include "bodies/trouble.h"

/* Exit codes: 0 success, 1 a result misses its bound or the simulation failed, 2 wrong use or bad input. */
enum { EXIT_GOOD = 0, EXIT_MISSED = 1, EXIT_USAGE = 2 }; /* 128 + its number: a run that a signal has broken off */

int cli_run(int count, char **words);
int cli_check(int count, char **words);
int cli_reproduce(int count, char **words);
int cli_plan(int count, char **words);
int cli_impact(int count, char **words);
int cli_fit(int count, char **words);
int cli_laws(int count, char **words);

/* Name that messages begin with; "scree" unless a program changes it. */
extern const char *cli_program;

/* An option of a subcommand. `value` receives the word after it (or after "="), `flag` is set to 1; one of the two is
 * NULL. An option that may be given several times has `list` and `list_count` instead. */
struct cli_option {
    const char *name; /* with its dashes */
    const char **value;
    int *flag;
    const char **list;
    int *list_count, list_capacity;
};

/* Sort words into options (ended by a NULL name) and the rest, which is moved to the front of `words`; `count` receives
 * how many. Returns EXIT_GOOD, or EXIT_USAGE after a message; -1 if the help was asked for (and printed). */
int cli_parse(int *count, char **words, const struct cli_option *options, const char *help);

/* Print "scree: text" (or the name in cli_program) on standard error and return EXIT_USAGE. */
SCREE_PRINTF(1, 2) int cli_complain(const char *format, ...);

/* Complains if the environment variable SCREE_ISA names no processor's path; EXIT_GOOD if it does, or isn't there. */
int cli_check_isa(void);

/* The exit code that goes with a status. */
int cli_exit_code(scree_status status);

/* The folder for the results of a file, "scenes/drop.toml" -> "drop", with `ending` behind it; `unnamed` for standard
 * input. To be freed; NULL if there is no memory. */
char *cli_default_folder(const char *path, const char *unnamed, const char *ending);

/* A whole number from 1 to `most`, 0 after a complaint. */
int cli_whole_number(const char *text, const char *option, int most);

/* Threads asked for by --threads (NULL: not given, one for each processor); 0 after a complaint. */
int cli_threads(const char *text);

#endif
