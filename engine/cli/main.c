/* The program: finds the subcommand and hands over. */
#include "engine/cli/cli.h"
#include "engine/scree.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "scree " SCREE_VERSION ": a discrete-element engine for people who study contacts\n"
    "\n"
    "usage: scree COMMAND [OPTION …]\n"
    "\n"
    "  run SCENE        simulate a scene; tables and frames into a folder\n"
    "  check SCENE      validate a scene and print its plan: what runs, what is skipped, the step and why\n"
    "  reproduce [FIGURE …]\n"
    "                   the verification experiments and the figures of the process model\n"
    "  plan TRANSPORT   motion profiles for operating speeds, characteristic map, servo tables\n"
    "  impact           two bodies meet: restitution, rebound, contact time, forces, over a sweep\n"
    "  fit FIT          parameters of a scene, adjusted to measured records, with confidence intervals\n"
    "  laws [NAME]      the catalogue of contact laws: formula, source, parameters\n"
    "\n"
    "`scree COMMAND --help` tells more. Exit status: 0 success, 1 a result misses its bound, a simulation had to\n"
    "stop or gnuplot failed, 2 wrong use, bad input or a file that can't be written,\n"
    "130 or 143 a run interrupted by Ctrl-C or SIGTERM.\n";

static const struct {
    const char *name;
    int (*run)(int count, char **words);
} commands[] = {{"run", cli_run},   {"check", cli_check},   {"reproduce", cli_reproduce},
                {"plan", cli_plan}, {"impact", cli_impact}, {"fit", cli_fit},
                {"laws", cli_laws}};

enum { COMMANDS = sizeof commands / sizeof commands[0] };

static int dispatch(int count, char **words) {
    if (count < 2 || strcmp(words[1], "--help") == 0 || strcmp(words[1], "-h") == 0 || strcmp(words[1], "help") == 0) {
        fputs(help, count < 2 ? stderr : stdout);
        return count < 2 ? EXIT_USAGE : EXIT_GOOD;
    }
    if (strcmp(words[1], "--version") == 0) {
        puts("scree " SCREE_VERSION);
        return EXIT_GOOD;
    }
    if (cli_check_isa()) return EXIT_USAGE;
    const char *names[COMMANDS + 1] = {0};
    for (int k = 0; k < COMMANDS; k++) {
        names[k] = commands[k].name;
        if (strcmp(words[1], names[k]) == 0) return commands[k].run(count - 2, words + 2);
    }
    return cli_complain("there is no command \"%s\"%s", words[1], scree_hint(words[1], names).text);
}

int main(int count, char **words) {
    int code = dispatch(count, words);
    /* What was printed has to arrive: a full device must not look like success. */
    if ((fflush(stdout) != 0 || ferror(stdout)) && code != EXIT_USAGE)
        return cli_complain("standard output: %s", errno ? strerror(errno) : "write error");
    return code;
}
