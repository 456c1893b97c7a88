/* TOML reader: recursive descent over the text, nodes in chunks that are freed together. Depth, size and the number of
 * keys in a table are bounded, so that no input can exhaust stack, memory or patience. */
#include "engine/toml.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_KEYS = 256, MOST_NODES = 4000000, MOST_PARTS = 16 };

/* How a table came to be, which decides what may still be added to it (TOML 1.0, sections Table, Inline Table). */
enum { BY_PARENT = 0, BY_HEADER, BY_DOTTED_KEY, INLINE, ARRAY_OF_TABLES };

struct scree_toml_chunk {
    struct scree_toml_chunk *next;
    size_t used, size;
    _Alignas(16) char memory[];
};

struct parser {
    const char *at, *end, *line_start;
    int line, depth;
    const char *name;
    struct scree_toml_document *document;
    scree_trouble *trouble;
    scree_status status;
};

/* ---- memory and errors ---- */

static void *take(struct scree_toml_document *document, size_t size) {
    struct scree_toml_chunk *chunk = document->chunks;
    size = (size + 15) / 16 * 16;
    if (!chunk || chunk->size - chunk->used < size) {
        size_t room = size > 65536 ? size : 65536;
        chunk = malloc(sizeof *chunk + room);
        if (!chunk) return NULL;
        *chunk = (struct scree_toml_chunk){.next = document->chunks, .size = room};
        document->chunks = chunk;
    }
    void *memory = chunk->memory + chunk->used;
    chunk->used += size;
    return memory;
}

SCREE_PRINTF(4, 5)
static scree_status complain_at(struct parser *p, int line, int column, const char *format, ...) {
    va_list arguments;
    if (p->status) return p->status;
    va_start(arguments, format);
    p->status = scree_report_at(p->trouble, SCREE_BAD_INPUT, p->name, line, column, format, arguments);
    va_end(arguments);
    return p->status;
}

static int column_of(const struct parser *p) { return (int)(p->at - p->line_start) + 1; }

#define complain(p, ...) complain_at((p), (p)->line, column_of(p), __VA_ARGS__)

static struct scree_toml *new_node(struct parser *p, enum scree_toml_type type) {
    if (p->status) return NULL;
    struct scree_toml *node = ++p->document->nodes <= MOST_NODES ? take(p->document, sizeof *node) : NULL;
    if (!node) {
        p->status = scree_report(p->trouble, SCREE_NO_MEMORY, NULL, "%s:%d: too many values to hold in memory", p->name,
                                 p->line);
        return NULL;
    }
    *node = (struct scree_toml){.type = type, .line = p->line, .column = column_of(p)};
    return node;
}

static void append(struct scree_toml *parent, struct scree_toml *child) {
    if (parent->last)
        parent->last->next = child;
    else
        parent->first = child;
    parent->last = child;
    parent->count++;
}

const char *scree_toml_type_name(enum scree_toml_type type) {
    static const char *const names[] = {"a table", "an array", "a string", "an integer", "a number", "true or false"};
    return names[type];
}

/* ---- characters ---- */

static int peek(const struct parser *p) { return p->at < p->end ? (unsigned char)*p->at : -1; }

static void skip_blanks(struct parser *p) {
    while (peek(p) == ' ' || peek(p) == '\t') p->at++;
}

static int at_newline(const struct parser *p) {
    return peek(p) == '\n' || (peek(p) == '\r' && p->at + 1 < p->end && p->at[1] == '\n');
}

static void skip_newline(struct parser *p) {
    p->at += *p->at == '\r' ? 2 : 1;
    p->line++;
    p->line_start = p->at;
}

static int is_control(int c) { return (c >= 0 && c < 0x20 && c != '\t') || c == 0x7f; }

static void skip_comment(struct parser *p) {
    if (peek(p) != '#') return;
    while (peek(p) >= 0 && !at_newline(p)) {
        if (is_control(peek(p))) {
            complain(p, "control character in a comment");
            return;
        }
        p->at++;
    }
}

/* Blanks, comments and newlines, as they may stand between the values of an array. */
static void skip_space(struct parser *p) {
    for (;;) {
        skip_blanks(p);
        skip_comment(p);
        if (p->status || !at_newline(p)) return;
        skip_newline(p);
    }
}

/* Length of the UTF-8 sequence at s (RFC 3629), 0 if it is not one. */
static int utf8_length(const unsigned char *s, const unsigned char *end) {
    int length = s[0] < 0x80 ? 1 : s[0] >= 0xc2 && s[0] < 0xe0 ? 2 : s[0] >= 0xe0 && s[0] < 0xf0 ? 3 : 0;
    if (s[0] >= 0xf0 && s[0] < 0xf5) length = 4;
    if (length == 0 || end - s < length) return 0;
    for (int k = 1; k < length; k++)
        if ((s[k] & 0xc0) != 0x80) return 0;
    if (s[0] == 0xe0 && s[1] < 0xa0) return 0;
    if (s[0] == 0xed && s[1] > 0x9f) return 0;
    if (s[0] == 0xf0 && s[1] < 0x90) return 0;
    if (s[0] == 0xf4 && s[1] > 0x8f) return 0;
    return length;
}

static void check_utf8(struct parser *p) {
    const unsigned char *s = (const unsigned char *)p->at, *end = (const unsigned char *)p->end;
    const unsigned char *line_start = s;
    int line = 1;
    while (s < end) {
        int length = utf8_length(s, end);
        if (length == 0) {
            complain_at(p, line, (int)(s - line_start) + 1, "this is not UTF-8 text");
            return;
        }
        if (*s == '\n') {
            line++;
            line_start = s + 1;
        }
        s += length;
    }
}

/* ---- strings and keys ---- */

static char *put_utf8(char *to, unsigned long code) {
    if (code < 0x80) {
        *to++ = (char)code;
    } else if (code < 0x800) {
        *to++ = (char)(0xc0 | code >> 6);
        *to++ = (char)(0x80 | (code & 0x3f));
    } else if (code < 0x10000) {
        *to++ = (char)(0xe0 | code >> 12);
        *to++ = (char)(0x80 | (code >> 6 & 0x3f));
        *to++ = (char)(0x80 | (code & 0x3f));
    } else {
        *to++ = (char)(0xf0 | code >> 18);
        *to++ = (char)(0x80 | (code >> 12 & 0x3f));
        *to++ = (char)(0x80 | (code >> 6 & 0x3f));
        *to++ = (char)(0x80 | (code & 0x3f));
    }
    return to;
}

/* The character after a backslash; p->at stands on it. */
static char *put_escape(struct parser *p, char *to) {
    static const char names[] = "btnfr\"\\", codes[] = "\b\t\n\f\r\"\\";
    int c = peek(p);
    const char *found = c > 0 ? strchr(names, c) : NULL;
    if (found) {
        p->at++;
        *to++ = codes[found - names];
        return to;
    }
    int digits = c == 'u' ? 4 : c == 'U' ? 8 : 0;
    unsigned long code = 0;
    for (int k = 1; k <= digits; k++) {
        int d = p->at + k < p->end ? (unsigned char)p->at[k] : 0;
        if (!isxdigit(d)) digits = 0;
        code = code * 16 + (unsigned long)(isdigit(d) ? d - '0' : tolower(d) - 'a' + 10);
    }
    if (digits == 0 || code == 0 || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) {
        complain(p, "unknown or unsupported escape sequence in a string");
        return to;
    }
    p->at += 1 + digits;
    return put_utf8(to, code);
}

static const char *parse_string(struct parser *p) {
    char quote = *p->at;
    if (p->end - p->at >= 3 && p->at[1] == quote && p->at[2] == quote) {
        complain(p, "multi-line strings aren't supported here");
        return NULL;
    }
    p->at++;
    const char *close = p->at; /* the result is no longer than the text up to the closing quote */
    while (close < p->end && *close != quote && *close != '\n') close += quote == '"' && *close == '\\' ? 2 : 1;
    char *string = take(p->document, (size_t)(close - p->at) + 1), *to = string;
    if (!string) {
        p->status = scree_report(p->trouble, SCREE_NO_MEMORY, NULL, "%s: no memory for a string", p->name);
        return NULL;
    }
    while (!p->status && peek(p) != quote) {
        if (peek(p) < 0 || at_newline(p))
            complain(p, "this string isn't closed on its line");
        else if (is_control(peek(p)))
            complain(p, "control character in a string");
        else if (quote == '"' && peek(p) == '\\') {
            p->at++;
            to = put_escape(p, to);
        } else
            *to++ = *p->at++;
    }
    if (p->status) return NULL;
    p->at++;
    *to = '\0';
    return string;
}

static int is_bare(int c) { return c > 0 && c < 0x80 && (isalnum(c) || c == '_' || c == '-'); }

static const char *parse_key(struct parser *p) {
    if (peek(p) == '"' || peek(p) == '\'') return parse_string(p);
    const char *start = p->at;
    while (is_bare(peek(p))) p->at++;
    size_t length = (size_t)(p->at - start);
    if (length == 0) {
        complain(p, "expected a key");
        return NULL;
    }
    char *key = take(p->document, length + 1);
    if (!key) {
        p->status = scree_report(p->trouble, SCREE_NO_MEMORY, NULL, "%s: no memory for a key", p->name);
        return NULL;
    }
    memcpy(key, start, length);
    key[length] = '\0';
    return key;
}

/* A dotted key into parts[]; returns how many. */
static int parse_dotted_key(struct parser *p, const char *parts[MOST_PARTS]) {
    int count = 0;
    for (;;) {
        skip_blanks(p);
        if (count == MOST_PARTS) complain(p, "a key of more than %d parts", MOST_PARTS);
        if (p->status) return 0;
        parts[count++] = parse_key(p);
        if (p->status) return 0;
        skip_blanks(p);
        if (peek(p) != '.') return count;
        p->at++;
    }
}

struct scree_toml *scree_toml_get(const struct scree_toml *table, const char *key) {
    for (struct scree_toml *child = table && table->type == SCREE_TOML_TABLE ? table->first : NULL; child;
         child = child->next)
        if (strcmp(child->key, key) == 0) return child;
    return NULL;
}

static struct scree_toml *add_child(struct parser *p, struct scree_toml *table, const char *key,
                                    struct scree_toml *child) {
    if (!child) return NULL;
    if (table->count >= MOST_KEYS) {
        complain(p, "a table with more than %d keys", MOST_KEYS);
        return NULL;
    }
    child->key = key;
    append(table, child);
    return child;
}

/* Table `key` of `table`, made if it isn't there. `how` tells who asks: BY_PARENT for the inner parts of a header,
 * BY_DOTTED_KEY for those of a dotted key. */
static struct scree_toml *enter(struct parser *p, struct scree_toml *table, const char *key, int how) {
    struct scree_toml *child = scree_toml_get(table, key);
    if (!child) {
        child = add_child(p, table, key, new_node(p, SCREE_TOML_TABLE));
        if (child) child->defined = (unsigned char)how;
        return child;
    }
    if (how == BY_PARENT && child->type == SCREE_TOML_ARRAY && child->defined == ARRAY_OF_TABLES) return child->last;
    int closed = child->type != SCREE_TOML_TABLE || child->defined == INLINE ||
                 (how == BY_DOTTED_KEY && child->defined != BY_DOTTED_KEY);
    if (!closed) return child;
    complain(p, "\"%s\" is %s already (line %d) and can't be extended here", key, scree_toml_type_name(child->type),
             child->line);
    return NULL;
}

/* ---- values ---- */

static struct scree_toml *parse_value(struct parser *p);

/* The characters of a number without underscores; 0 if they are not well placed or too many. */
static int strip_number(const char *from, const char *to, char digits[64]) {
    int count = 0;
    for (const char *c = from; c < to; c++) {
        if (*c == '_') {
            int between = c > from && c + 1 < to && isxdigit((unsigned char)c[-1]) && isxdigit((unsigned char)c[1]);
            if (!between) return 0;
            continue;
        }
        if (count == 63) return 0;
        digits[count++] = *c;
    }
    digits[count] = '\0';
    return count;
}

static int all_digits(const char *s, int base) {
    if (!*s) return 0;
    for (; *s; s++) {
        int c = tolower((unsigned char)*s);
        int value = isdigit(c) ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : 99;
        if (value >= base) return 0;
    }
    return 1;
}

/* TOML's grammar of a decimal float or integer: [+-] int [. digits] [e [+-] digits], no leading zero. */
static int is_decimal(const char *s, int *is_float) {
    *is_float = 0;
    if (*s == '+' || *s == '-') s++;
    if (!isdigit((unsigned char)*s) || (s[0] == '0' && isdigit((unsigned char)s[1]))) return 0;
    while (isdigit((unsigned char)*s)) s++;
    if (*s == '.') {
        *is_float = 1;
        if (!isdigit((unsigned char)*++s)) return 0;
        while (isdigit((unsigned char)*s)) s++;
    }
    if (*s == 'e' || *s == 'E') {
        *is_float = 1;
        s++;
        if (*s == '+' || *s == '-') s++;
        if (!isdigit((unsigned char)*s)) return 0;
        while (isdigit((unsigned char)*s)) s++;
    }
    return *s == '\0';
}

static int looks_like_date(const char *s) {
    return (isdigit((unsigned char)s[0]) && isdigit((unsigned char)s[1]) && isdigit((unsigned char)s[2]) &&
            isdigit((unsigned char)s[3]) && s[4] == '-') ||
           (isdigit((unsigned char)s[0]) && isdigit((unsigned char)s[1]) && s[2] == ':');
}

static struct scree_toml *parse_number(struct parser *p) {
    const char *start = p->at;
    const char *c = start;
    while (c < p->end && (isalnum((unsigned char)*c) || strchr("+-._:", *c)) && *c != '\0') c++;
    char s[64];
    int ok = strip_number(start, c, s) > 0, is_float = 0;
    if (c == start) {
        complain(p, "expected a value");
        return NULL;
    }
    if (ok && looks_like_date(s)) {
        complain(p, "dates and times aren't supported here");
        return NULL;
    }
    struct scree_toml *node = new_node(p, SCREE_TOML_INTEGER);
    if (!node) return NULL;
    const char *unsigned_part = s + (ok && (s[0] == '+' || s[0] == '-'));
    if (ok && (!strcmp(unsigned_part, "inf") || !strcmp(unsigned_part, "nan"))) {
        node->type = SCREE_TOML_FLOAT;
        node->number = unsigned_part[0] == 'i' ? HUGE_VAL : NAN;
        if (s[0] == '-') node->number = -node->number;
    } else if (ok && s[0] == '0' && (s[1] == 'x' || s[1] == 'o' || s[1] == 'b') && start[1] == s[1]) {
        int base = s[1] == 'x' ? 16 : s[1] == 'o' ? 8 : 2;
        ok = all_digits(s + 2, base) && strlen(s + 2) <= (base == 16 ? 15 : base == 8 ? 20 : 62);
        node->integer = ok ? strtoll(s + 2, NULL, base) : 0;
        node->number = (double)node->integer;
    } else if (ok && is_decimal(s, &is_float)) {
        ok = is_float || strlen(unsigned_part) <= 18;
        node->type = is_float ? SCREE_TOML_FLOAT : SCREE_TOML_INTEGER;
        node->integer = is_float || !ok ? 0 : strtoll(s, NULL, 10);
        node->number = is_float ? strtod(s, NULL) : (double)node->integer;
    } else {
        ok = 0;
    }
    if (!ok) {
        /* A shell has taken the quotes, most often. */
        const char *hint = isalpha((unsigned char)*start) ? "; a string stands in quotes (in a shell, '\"…\"')" : "";
        complain(p, "\"%.*s\" is no number, true, false, string, array or table%s",
                 (int)(c - start < 40 ? c - start : 40), start, hint);
        return NULL;
    }
    p->at = c;
    return node;
}

static struct scree_toml *parse_boolean(struct parser *p, const char *word) {
    struct scree_toml *node = new_node(p, SCREE_TOML_BOOLEAN);
    if (!node) return NULL;
    node->number = word[0] == 't';
    p->at += strlen(word);
    return node;
}

static struct scree_toml *parse_array(struct parser *p) {
    struct scree_toml *array = new_node(p, SCREE_TOML_ARRAY);
    if (!array) return NULL;
    p->at++;
    for (;;) {
        skip_space(p);
        if (p->status) return NULL;
        if (peek(p) == ']') break;
        struct scree_toml *value = parse_value(p);
        if (!value) return NULL;
        append(array, value);
        skip_space(p);
        if (peek(p) == ',')
            p->at++;
        else if (peek(p) != ']') {
            complain(p, "expected , or ] in the array that begins on line %d", array->line);
            return NULL;
        }
    }
    p->at++;
    return array;
}

/* key = value into a table. */
static void parse_pair(struct parser *p, struct scree_toml *table) {
    const char *parts[MOST_PARTS];
    int line = p->line, column = column_of(p);
    int count = parse_dotted_key(p, parts);
    if (p->status) return;
    if (peek(p) != '=') {
        complain(p, "expected = after the key \"%s\"", parts[count - 1]);
        return;
    }
    p->at++;
    skip_blanks(p);
    for (int k = 0; k + 1 < count && table; k++) table = enter(p, table, parts[k], BY_DOTTED_KEY);
    if (!table) return;
    struct scree_toml *known = scree_toml_get(table, parts[count - 1]);
    if (known) {
        complain_at(p, line, column, "\"%s\" is given twice (first on line %d)", parts[count - 1], known->line);
        return;
    }
    struct scree_toml *value = parse_value(p);
    if (value) value->key_column = column;
    add_child(p, table, parts[count - 1], value);
}

static struct scree_toml *parse_inline_table(struct parser *p) {
    struct scree_toml *table = new_node(p, SCREE_TOML_TABLE);
    if (!table) return NULL;
    p->at++;
    skip_blanks(p);
    if (peek(p) != '}') {
        for (;;) {
            parse_pair(p, table);
            if (p->status) return NULL;
            skip_blanks(p);
            if (peek(p) == '}') break;
            if (peek(p) != ',') {
                complain(p, "expected , or } in this table; an inline table stands on one line");
                return NULL;
            }
            p->at++;
            skip_blanks(p);
        }
    }
    p->at++;
    /* Nothing may be added later, neither to it nor to what its dotted keys made. */
    table->defined = INLINE;
    for (struct scree_toml *child = table->first; child; child = child->next)
        if (child->type == SCREE_TOML_TABLE) child->defined = INLINE;
    return table;
}

static int starts_with(const struct parser *p, const char *word) {
    size_t length = strlen(word);
    return (size_t)(p->end - p->at) >= length && memcmp(p->at, word, length) == 0 &&
           ((size_t)(p->end - p->at) == length || !is_bare((unsigned char)p->at[length]));
}

static struct scree_toml *parse_value(struct parser *p) {
    if (++p->depth > SCREE_TOML_DEEPEST) {
        complain(p, "values nested deeper than %d", SCREE_TOML_DEEPEST);
        return NULL;
    }
    struct scree_toml *node = NULL;
    int c = peek(p);
    if (c == '"' || c == '\'') {
        node = new_node(p, SCREE_TOML_STRING);
        if (node) node->string = parse_string(p);
    } else if (c == '[')
        node = parse_array(p);
    else if (c == '{')
        node = parse_inline_table(p);
    else if (starts_with(p, "true"))
        node = parse_boolean(p, "true");
    else if (starts_with(p, "false"))
        node = parse_boolean(p, "false");
    else
        node = parse_number(p);
    p->depth--;
    return p->status ? NULL : node;
}

/* ---- documents ---- */

/* [a.b] or [[a.b]]: returns the table that the following lines fill. */
static struct scree_toml *parse_header(struct parser *p) {
    const char *parts[MOST_PARTS];
    int array = p->end - p->at >= 2 && p->at[1] == '[', column = column_of(p);
    p->at += array ? 2 : 1;
    int count = parse_dotted_key(p, parts);
    if (p->status) return NULL;
    if (peek(p) != ']' || (array && (p->end - p->at < 2 || p->at[1] != ']'))) {
        complain(p, "expected %s after the name of the table", array ? "]]" : "]");
        return NULL;
    }
    p->at += array ? 2 : 1;
    struct scree_toml *table = p->document->root;
    for (int k = 0; k + 1 < count && table; k++) table = enter(p, table, parts[k], BY_PARENT);
    if (!table) return NULL;
    const char *key = parts[count - 1];
    struct scree_toml *known = scree_toml_get(table, key);
    if (array) {
        if (!known) {
            known = add_child(p, table, key, new_node(p, SCREE_TOML_ARRAY));
            if (known) known->defined = ARRAY_OF_TABLES;
        }
        if (known && known->defined != ARRAY_OF_TABLES)
            complain(p, "\"%s\" is %s already (line %d)", key, scree_toml_type_name(known->type), known->line);
        struct scree_toml *entry = new_node(p, SCREE_TOML_TABLE);
        if (!entry || !known) return NULL;
        entry->defined = BY_HEADER;
        entry->column = column;
        append(known, entry);
        return entry;
    }
    if (!known) known = add_child(p, table, key, new_node(p, SCREE_TOML_TABLE));
    if (known && known->type != SCREE_TOML_TABLE)
        complain(p, "\"%s\" is %s already (line %d)", key, scree_toml_type_name(known->type), known->line);
    else if (known && known->defined != BY_PARENT)
        complain(p, "the table [%s] is defined twice (first on line %d)", key, known->line);
    if (p->status) return NULL;
    known->defined = BY_HEADER;
    known->line = p->line;
    known->column = column;
    return known;
}

static void parse_document(struct parser *p) {
    struct scree_toml *table = p->document->root;
    for (;;) {
        skip_space(p);
        if (p->status || peek(p) < 0) return;
        if (peek(p) == '[')
            table = parse_header(p);
        else
            parse_pair(p, table);
        skip_blanks(p);
        skip_comment(p);
        if (p->status) return;
        if (peek(p) >= 0 && !at_newline(p)) complain(p, "expected the end of the line");
    }
}

static struct parser start(const char *text, size_t size, const char *name, struct scree_toml_document *document,
                           scree_trouble *trouble) {
    return (struct parser){.at = text,
                           .end = text + size,
                           .line_start = text,
                           .line = 1,
                           .name = name,
                           .document = document,
                           .trouble = trouble};
}

scree_status scree_toml_parse(const char *text, size_t size, const char *name, struct scree_toml_document *document,
                              scree_trouble *trouble) {
    *document = (struct scree_toml_document){0};
    if (size > SCREE_TOML_LARGEST)
        return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                            "%s: %zu MB is too large for a scene file (the most is %d MB); keep many bodies in a table",
                            name, size >> 20, SCREE_TOML_LARGEST >> 20);
    struct parser p = start(text, size, name, document, trouble);
    document->root = new_node(&p, SCREE_TOML_TABLE);
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) p.line_start = p.at += 3; /* a byte order mark */
    if (!p.status) check_utf8(&p);
    if (!p.status) parse_document(&p);
    return p.status;
}

void scree_toml_free(struct scree_toml_document *document) {
    while (document->chunks) {
        struct scree_toml_chunk *next = document->chunks->next;
        free(document->chunks);
        document->chunks = next;
    }
    document->root = NULL;
}

/* Entry of an array by the `name` that it has, or by number. */
static struct scree_toml *entry_of(const struct scree_toml *array, const char *part) {
    int number = 0;
    char *end;
    long wanted = strtol(part, &end, 10);
    for (struct scree_toml *entry = array->first; entry; entry = entry->next, number++) {
        const struct scree_toml *name = scree_toml_get(entry, "name");
        if (name && name->string && strcmp(name->string, part) == 0) return entry;
        if (*part && !*end && wanted == number) return entry;
    }
    return NULL;
}

static struct scree_toml *step_into(struct scree_toml *node, const char *part) {
    if (node->type == SCREE_TOML_ARRAY) return entry_of(node, part);
    return scree_toml_get(node, part);
}

/* A value from the command line, and all in it, has no place in the file. */
static void forget_place(struct scree_toml *node, const char *assignment) {
    node->line = node->column = node->key_column = 0;
    node->set = assignment;
    for (struct scree_toml *child = node->first; child; child = child->next) forget_place(child, assignment);
}

/* There is no such part of a table, or of an array of tables, which go by their names. */
static void miss(struct parser *p, const struct scree_toml *node, const char *part) {
    enum { MOST = 256 };
    const char *names[MOST + 1] = {0};
    int count = 0;
    for (const struct scree_toml *child = node->first; child && count < MOST; child = child->next) {
        const struct scree_toml *name = node->type == SCREE_TOML_ARRAY ? scree_toml_get(child, "name") : NULL;
        const char *called = name && name->type == SCREE_TOML_STRING ? name->string : child->key;
        if (called) names[count++] = called;
    }
    char entries[64] = "";
    struct scree_hint hint = scree_hint(part, names);
    if (!hint.text[0] && node->type == SCREE_TOML_ARRAY)
        snprintf(entries, sizeof entries, ": entries are numbered from 0 to %d", node->count - 1);
    complain_at(p, 0, 0, "there is no \"%s\" in this file%s%s", part, hint.text, entries);
}

/* Whether a key is like one that the table has; else it is of a table that the file doesn't have yet. */
static int is_misspelt(const struct scree_toml *table, const char *key) {
    for (const struct scree_toml *child = table->first; child; child = child->next)
        if (scree_nearest_name(key, (const char *const[]){child->key, NULL})) return 1;
    return 0;
}

scree_status scree_toml_set(struct scree_toml_document *document, const char *assignment, scree_trouble *trouble) {
    const char *parts[MOST_PARTS];
    size_t length = strlen(assignment);
    char *copy = take(document, length + 1); /* the values point into the text */
    if (!copy) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory");
    memcpy(copy, assignment, length + 1);
    struct parser p = start(copy, length, assignment, document, trouble);
    int count = parse_dotted_key(&p, parts);
    if (!p.status && peek(&p) != '=') complain_at(&p, 0, 0, "expected key=value");
    if (p.status) return p.status;
    p.at++;
    skip_blanks(&p);
    struct scree_toml *value = parse_value(&p), *node = document->root;
    skip_blanks(&p);
    if (!p.status && peek(&p) >= 0) complain_at(&p, 0, 0, "something follows the value");
    for (int k = 0; k + 1 < count && !p.status; k++) {
        struct scree_toml *child = step_into(node, parts[k]);
        if (!child && node->type == SCREE_TOML_TABLE && !is_misspelt(node, parts[k])) {
            child = add_child(&p, node, parts[k], new_node(&p, SCREE_TOML_TABLE));
            if (child) forget_place(child, assignment);
        } else if (!child)
            miss(&p, node, parts[k]);
        node = child;
    }
    if (p.status) return p.status;
    struct scree_toml *known = step_into(node, parts[count - 1]);
    forget_place(value, assignment);
    if (known) {
        /* In place of the old value, with its place among its siblings. */
        value->next = known->next;
        value->key = known->key;
        *known = *value;
        return SCREE_OK;
    }
    if (node->type == SCREE_TOML_TABLE)
        add_child(&p, node, parts[count - 1], value);
    else
        miss(&p, node, parts[count - 1]);
    return p.status;
}

const struct scree_toml *scree_toml_nearest(const struct scree_toml *table, const char *path) {
    const struct scree_toml *node = table;
    while (*path) {
        char part[64];
        size_t length = strcspn(path, ".");
        snprintf(part, sizeof part, "%.*s", (int)length, path);
        const struct scree_toml *child = scree_toml_get(node, part);
        if (!child) return node;
        node = child;
        path += length + (path[length] == '.');
    }
    return node;
}
