/* Options of the programs: sorting words into options and names, messages, exit codes. */
#include "engine/cli/cli.h"
#include "engine/scree.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *cli_program = "scree";

int cli_complain(const char *format, ...) {
    va_list arguments;
    fprintf(stderr, "%s: ", cli_program);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return EXIT_USAGE;
}

int cli_check_isa(void) {
    const char *known[] = {"baseline", "avx2", "avx512", NULL}, *wanted = getenv("SCREE_ISA");
    for (int k = 0; wanted && known[k]; k++)
        if (strcmp(wanted, known[k]) == 0) return EXIT_GOOD;
    return wanted && *wanted ? cli_complain("SCREE_ISA is baseline, avx2 or avx512, not \"%s\"", wanted) : EXIT_GOOD;
}

int cli_exit_code(scree_status status) {
    return status == SCREE_OK                                    ? EXIT_GOOD
           : status == SCREE_FAILED || status == SCREE_NO_MEMORY ? EXIT_MISSED
                                                                 : EXIT_USAGE;
}

char *cli_default_folder(const char *path, const char *unnamed, const char *ending) {
    const char *slash = strrchr(path, '/'), *name = strcmp(path, "-") == 0 ? unnamed : slash ? slash + 1 : path;
    char *folder = malloc(strlen(name) + strlen(ending) + 1);
    if (!folder) return NULL;
    strcpy(folder, name);
    char *dot = strrchr(folder, '.');
    if (dot && dot > folder) *dot = '\0';
    return strcat(folder, ending);
}

int cli_whole_number(const char *text, const char *option, int most) {
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (!*text || *end || errno || value < 1 || value > most) {
        cli_complain("%s takes a whole number from 1 to %d, not \"%s\"", option, most, text);
        return 0;
    }
    return (int)value;
}

int cli_threads(const char *text) {
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    return text ? cli_whole_number(text, "--threads", SCREE_MOST_THREADS) : processors > 0 ? (int)processors : 1;
}

/* The option that a word is, with its length; NULL if none. */
static const struct cli_option *find_option(const char *word, const struct cli_option *options, size_t *length) {
    *length = strcspn(word, "=");
    for (; options->name; options++)
        if (strlen(options->name) == *length && strncmp(options->name, word, *length) == 0) return options;
    return NULL;
}

static int unknown_option(const char *word, const struct cli_option *options) {
    const char *names[32] = {0};
    for (int k = 0; options[k].name && k < 31; k++) names[k] = options[k].name;
    return cli_complain("unknown option %s%s", word, scree_hint(word, names).text);
}

static int take_option(const struct cli_option *option, const char *value) {
    if (option->list) {
        if (*option->list_count == option->list_capacity)
            return cli_complain("%s is given more than %d time%s", option->name, option->list_capacity,
                                option->list_capacity > 1 ? "s" : "");
        option->list[(*option->list_count)++] = value;
    } else
        *option->value = value;
    return EXIT_GOOD;
}

int cli_parse(int *count, char **words, const struct cli_option *options, const char *text) {
    int rest = 0, only_names = 0;
    for (int k = 0; k < *count; k++) {
        const char *word = words[k];
        if (only_names || word[0] != '-' || !word[1]) {
            words[rest++] = words[k];
            continue;
        }
        if (strcmp(word, "--") == 0) {
            only_names = 1;
            continue;
        }
        if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
            fputs(text, stdout);
            return -1;
        }
        size_t length;
        const struct cli_option *option = find_option(word, options, &length);
        if (!option) return unknown_option(word, options);
        if (option->flag) {
            if (word[length]) return cli_complain("%s takes no value", option->name);
            *option->flag = 1;
            continue;
        }
        const char *value = word[length] ? word + length + 1 : k + 1 < *count ? words[++k] : NULL;
        if (!value) return cli_complain("%s needs a value", option->name);
        int code = take_option(option, value);
        if (code) return code;
    }
    *count = rest;
    return EXIT_GOOD;
}
