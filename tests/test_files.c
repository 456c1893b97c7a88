/* engine/: the TOML reader, scene files and tables; above all what they refuse, and where they say it is. */
#include "engine/table.h"
#include "engine/toml.h"
#include "tests/scenes.h"

#include <locale.h>
#include <unistd.h>

/* ---- TOML ---- */

static scree_status parse(const char *text, struct scree_toml_document *document, scree_trouble *trouble) {
    return scree_toml_parse(text, strlen(text), "t.toml", document, trouble);
}

static void test_accepted(void) {
    const char *text = "# comment\n"
                       "title = \"a\\tb\\u00e9\\\\ \\\"q\\\"\" # end\n"
                       "literal = 'C:\\path'\r\n"
                       "\"quoted key\" = 1\n"
                       "integer = -1_000\nhex = 0xff_ff\noctal = 0o17\nbinary = 0b101\n"
                       "float = 6.02e+23\nsmall = -1e-3\nplain = 3.5\nunder = 1_0.2_5\nbig = inf\nnone = -nan\n"
                       "yes = true\nno = false\n"
                       "array = [1, [2.5, 'x'], # comment\n  {a = 1},\n]\n"
                       "empty = []\nalso = {}\n"
                       "a.b.c = 1\na.b.d = 2\n"
                       "[table]\nkey = 1\n"
                       "[table.inner]\nkey = 2\n"
                       "[other.deep]\nkey = 3\n"
                       "[other]\nkey = 4\n"
                       "[[list]]\nname = \"one\"\n[list.sub]\nx = 1\n[[list.items]]\ny = 2\n"
                       "[[list]]\nname = \"two\"\npoint = { x = 1.5, y.z = 2 }\n";
    struct scree_toml_document document;
    scree_trouble trouble = {0};
    CHECK(parse(text, &document, &trouble) == SCREE_OK);
    if (trouble.text[0]) printf("%s\n", trouble.text);
    const struct scree_toml *root = document.root;
    CHECK(strcmp(scree_toml_get(root, "title")->string, "a\tb\xc3\xa9\\ \"q\"") == 0);
    CHECK(strcmp(scree_toml_get(root, "literal")->string, "C:\\path") == 0);
    CHECK(scree_toml_get(root, "quoted key")->integer == 1);
    CHECK(scree_toml_get(root, "integer")->integer == -1000 && scree_toml_get(root, "integer")->number == -1000.0);
    CHECK(scree_toml_get(root, "hex")->integer == 65535 && scree_toml_get(root, "octal")->integer == 15);
    CHECK(scree_toml_get(root, "binary")->integer == 5);
    CHECK(scree_toml_get(root, "float")->number == 6.02e23 && scree_toml_get(root, "small")->number == -1e-3);
    CHECK(scree_toml_get(root, "under")->number == 10.25);
    CHECK(isinf(scree_toml_get(root, "big")->number) && isnan(scree_toml_get(root, "none")->number));
    CHECK(scree_toml_get(root, "yes")->number == 1.0 && scree_toml_get(root, "no")->type == SCREE_TOML_BOOLEAN);
    CHECK(scree_toml_get(root, "array")->count == 3 && scree_toml_get(root, "empty")->count == 0);
    CHECK(scree_toml_get(scree_toml_get(scree_toml_get(root, "a"), "b"), "d")->integer == 2);
    CHECK(scree_toml_get(scree_toml_get(scree_toml_get(root, "table"), "inner"), "key")->integer == 2);
    CHECK(scree_toml_get(scree_toml_get(root, "other"), "key")->integer == 4);
    const struct scree_toml *list = scree_toml_get(root, "list");
    CHECK(list->count == 2 && scree_toml_get(scree_toml_get(list->first, "items")->first, "y")->integer == 2);
    CHECK(scree_toml_get(scree_toml_get(scree_toml_get(list->last, "point"), "y"), "z")->integer == 2);
    CHECK(scree_toml_get(list->last, "point")->line == 40 && scree_toml_get(list->last, "point")->column == 9);
    CHECK(scree_toml_nearest(list->last, "point.x")->number == 1.5);
    CHECK(scree_toml_nearest(list->last, "point.q") == scree_toml_get(list->last, "point"));

    CHECK(scree_toml_set(&document, "list.two.point.x = 7", &trouble) == SCREE_OK);
    CHECK(scree_toml_get(scree_toml_get(list->last, "point"), "x")->integer == 7);
    CHECK(scree_toml_set(&document, "list.0.name=\"uno\"", &trouble) == SCREE_OK);
    CHECK(strcmp(scree_toml_get(list->first, "name")->string, "uno") == 0);
    CHECK(scree_toml_set(&document, "table.added=[1,2]", &trouble) == SCREE_OK);
    CHECK(scree_toml_get(scree_toml_get(root, "table"), "added")->count == 2);
    static const char *const bad[] = {"nowhere.x=1", "list.five.x=1", "table.key", "table.key=", "table.key=1 2",
                                      "=1",          "list.9=1"};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++)
        CHECK(scree_toml_set(&document, bad[k], &trouble) == SCREE_BAD_INPUT && trouble.text[0]);
    scree_toml_free(&document);
}

static void test_refused(void) {
    /* Text, and what the message must hold. All of it is invalid TOML 1.0, or not supported (the last four). */
    static const char *const cases[][2] = {
        {"a = 1\na = 2", "2:1: \"a\" is given twice (first on line 1)"},
        {"[a]\n[a]", "2:"},
        {"[a]\nb = 1\n[a.b]", "is an integer already"},
        {"a = {b = 1}\na.c = 2", "can't be extended"},
        {"a = {b = 1}\n[a.c]", "can't be extended"},
        {"a.b = 1\n[a]\nc = 2", "defined twice"},
        {"[x.a]\n[x]\na.c = 1", "can't be extended"},
        {"a = [1]\n[[a]]", "is an array already"},
        {"[[a]]\n[a]", "is an array already"},
        {"a = {b = {c = 1}, b.d = 2}", "can't be extended"},
        {"a", "expected ="},
        {"= 1", "expected a key"},
        {"a = ", "1:5: expected a value"},
        {"a = 01", "no number"},
        {"a = 1.", "no number"},
        {"a = .5", "no number"},
        {"a = 1__0", "no number"},
        {"a = _1", "no number"},
        {"a = 1e", "no number"},
        {"a = +0x1", "no number"},
        {"a = 0xg", "no number"},
        {"a = 1 2", "expected the end of the line"},
        {"a = \"x", "isn't closed"},
        {"a = \"\\q\"", "escape"},
        {"a = \"\\ud800\"", "escape"},
        {"a = \"tab\x01\"", "control character"},
        {"a = 'x\ny'", "isn't closed"},
        {"a = [1, 2", "expected , or ]"},
        {"a = [1 2]", "expected , or ]"},
        {"a = {b = 1,\n c = 2}", "expected a key"},
        {"a = {b = 1", "expected , or }"},
        {"a = {b = 1,}", "expected a key"},
        {"[a", "expected ]"},
        {"[[a]", "expected ]]"},
        {"[]", "expected a key"},
        {"a = tru", "no number, true, false"},
        {"# \x07", "control character in a comment"},
        {"a = \"\xff\"", "1:6: this is not UTF-8"},
        {"a = \"\xc0\x80\"", "not UTF-8"},
        {"a = 1\r b = 2", "expected the end of the line"},
        {"a = \"\"\"x\"\"\"", "multi-line strings aren't supported"},
        {"a = 1979-05-27", "dates and times aren't supported"},
        {"a = 07:32:00", "dates and times aren't supported"},
        {"a = '''x'''", "multi-line"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        struct scree_toml_document document;
        scree_trouble trouble = {0};
        CHECK(parse(cases[k][0], &document, &trouble) == SCREE_BAD_INPUT);
        CONTAINS(trouble.text, "t.toml:");
        CONTAINS(trouble.text, cases[k][1]);
        scree_toml_free(&document);
    }
}

/* A text of `count` times the same piece. */
static char *repeat(const char *head, const char *piece, size_t count, const char *tail) {
    size_t length = strlen(piece), size = strlen(head) + count * length + strlen(tail) + 1;
    char *text = malloc(size), *to = text + sprintf(text, "%s", head);
    for (size_t k = 0; k < count; k++, to += length) memcpy(to, piece, length);
    strcpy(to, tail);
    return text;
}

/* Sizes that could exhaust stack, memory or patience. */
static void test_monsters(void) {
    static const struct {
        const char *head, *piece, *tail, *message;
        size_t count;
    } monsters[] = {
        {"a = ", "[", "", "nested deeper", 1000000},        {"a = ", "{b = ", "", "nested deeper", 1000000},
        {"", "a.", "a = 1", "more than 16 parts", 1000000}, {"[", "a.", "a]", "more than 16 parts", 1000000},
        {"a = [", "1,", "]", "too many values", 5000000},   {"a = [", "\"x\",", "]", "too many values", 5000000},
        {"", "[[a]]\n", "", "too many values", 5000000},    {"", "# filler\n", "", "too large", 4000000},
        {"a = \"", "x", "", "isn't closed", 3000000},
    };
    for (size_t k = 0; k < sizeof monsters / sizeof monsters[0]; k++) {
        char *text = repeat(monsters[k].head, monsters[k].piece, monsters[k].count, monsters[k].tail);
        struct scree_toml_document document;
        scree_trouble trouble = {0};
        CHECK(parse(text, &document, &trouble) != SCREE_OK);
        CONTAINS(trouble.text, monsters[k].message);
        scree_toml_free(&document);
        free(text);
    }
    /* As many keys in one table as no scene needs. */
    char *text = malloc(400 * 16), *to = text;
    for (int n = 0; n < 400; n++) to += sprintf(to, "k%d = 1\n", n);
    struct scree_toml_document document;
    scree_trouble trouble;
    CHECK(parse(text, &document, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "257:");
    scree_toml_free(&document);
    free(text);
}

/* ---- tables ---- */

static scree_status parse_table(char *text, size_t size, struct scree_table *table, scree_trouble *trouble) {
    return scree_table_parse(text, size, "t.csv", "time", table, trouble);
}

static void test_tables(void) {
    struct scree_table table;
    scree_trouble trouble;
    char good[] = "\xef\xbb\xbf# comment\n\"time_s\", position_m ,note\n0,1.5,2\n\n1e-3,\"-2\",+.5\r\n";
    CHECK(parse_table(good, sizeof good - 1, &table, &trouble) == SCREE_OK);
    CHECK(table.rows == 2 && table.columns == 3 && table.header == 2);
    CHECK(table.column[1][1] == -2.0 && table.column[0][1] == 1e-3);
    CHECK(strcmp(table.name[0], "time_s") == 0 && strcmp(table.name[1], "position_m") == 0);
    CHECK(scree_table_column(&table, -1) == NULL && scree_table_column(&table, 2)[1] == 0.5);
    scree_table_free(&table);
    static const char *const bad[][2] = {
        {"", "empty"},
        {"1,2\n3,4\n", "t.csv:1:1: expected a header"},
        {"a,b\n1,x\n", "t.csv:2:3: \"x\" is no number"},
        {"a,b\n1,2\n1\n", "t.csv:3:1: wrong number of columns"},
        {"a,b\n1,2,3\n", "t.csv:2:5: wrong number of columns"},
        {"a,b\n1,2 x\n", "t.csv:2:3: \"2 x\" is no number"},
        {"a,b\n0x10,2\n", "t.csv:2:1: \"0x10\" is no number"},
        {"a,b\n1,inf\n", "t.csv:2:3: \"inf\" is no number"},
        {"a,b\n1,nan\n", "t.csv:2:3: \"nan\" is no number"},
        {"a,b\n1,1e999\n", "t.csv:2:3: \"1e999\" is no number"},
        {"a,b\n1,\n", "t.csv:2:3: \"\" is no number"},
        {"a,b\n0,\"12\n", "t.csv:2:3: \"12: a quote that isn't closed"},
        {"a,b\n\"0.5,1\n", "t.csv:2:1: \"0.5: a quote that isn't closed"},
        {"a,b\n0,\"1\"2\n", "t.csv:2:3: \"1\"2: a quote that isn't closed"},
        {"a,\"b\n0,1\n", "t.csv:1:3: \"b: a quote that isn't closed"},
        {"a, a\n1,2\n", "t.csv:1:4: there are two columns \"a\""},
        {"a;b\n1;2\n", "t.csv:1:1: \"a;b\": columns are separated by commas"},
        {"# c\nx,time_s\n\n1,2\n# c\n3,2\n", "t.csv:6:3: time_s must increase: 2 after 2"}};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        char text[64];
        strcpy(text, bad[k][0]);
        CHECK(parse_table(text, strlen(text), &table, &trouble) == SCREE_BAD_INPUT);
        CONTAINS(trouble.text, bad[k][1]);
    }
    static const char *const words[] = {"w", NULL};
    char open[] = "a,w\n1,\"x\n2,y\n", closed[] = "a,w\n1,\"\"\"x\"\"\"\n2,y\n";
    CHECK(scree_table_parse_words(open, sizeof open - 1, "t.csv", words, &table, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "t.csv:2:3: \"x: a quote that isn't closed");
    CHECK(scree_table_parse_words(closed, sizeof closed - 1, "t.csv", words, &table, &trouble) == SCREE_OK);
    CHECK(strcmp(table.word[1][0], "\"x\"") == 0);
    scree_table_free(&table);
    char cut[] = "a,b\n1,2\n3,\0004\n5,6\n";
    CHECK(parse_table(cut, sizeof cut - 1, &table, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "t.csv:3:3: this is no text");
}

/* ---- scene files ---- */

static const char good_scene[] = "title = \"t\"\n"                                                     /* 1 */
                                 "gravity = [0, 0, -9.81]\n"                                           /* 2 */
                                 "[time]\n"                                                            /* 3 */
                                 "end = 0.01\n"                                                        /* 4 */
                                 "step = 1e-5\n"                                                       /* 5 */
                                 "[[material]]\n"                                                      /* 6 */
                                 "name = \"a\"\n"                                                      /* 7 */
                                 "density = 1000\n"                                                    /* 8 */
                                 "[[contact]]\n"                                                       /* 9 */
                                 "between = [\"a\", \"a\"]\n"                                          /* 10 */
                                 "normal = { law = \"linear\", stiffness = 1e4, restitution = 0.5 }\n" /* 11 */
                                 "friction = { law = \"ramp\", kinetic = 0.3, threshold = 0.01 }\n"    /* 12 */
                                 "shared_by = 1\n"                                                     /* 13 */
                                 "[[motion]]\n"                                                        /* 14 */
                                 "name = \"m\"\n"                                                      /* 15 */
                                 "kind = \"table\"\n"                                                  /* 16 */
                                 "rows = [[0, 0], [1, 1]]\n"                                           /* 17 */
                                 "[[body]]\n"                                                          /* 18 */
                                 "name = \"one\"\n"                                                    /* 19 */
                                 "shape = { box = [0.1, 0.1, 0.1], rounding = 0.01 }\n"                /* 20 */
                                 "material = \"a\"\n"                                                  /* 21 */
                                 "position = [0, 0, 0]\n"                                              /* 22 */
                                 "joint = { x = \"m\", others = \"fixed\" }\n"                         /* 23 */
                                 "[[body]]\n"                                                          /* 24 */
                                 "name = \"two\"\n"                                                    /* 25 */
                                 "shape = { sphere = 0.1 }\n"                                          /* 26 */
                                 "material = \"a\"\n"                                                  /* 27 */
                                 "position = [0, 0, 0.15]\n"                                           /* 28 */
                                 "[output]\n"                                                          /* 29 */
                                 "every = 1e-3\n"                                                      /* 30 */
                                 "write = [\"bodies.csv\"]\n";                                         /* 31 */

/* Text in the place of a line of the good scene (0: behind the last), and how that is refused. */
struct bad_line {
    int line;
    const char *text, *where, *message;
};

/* The good scene with line `line` replaced (0: `text` appended). */
static char *with_line(int line, const char *text) {
    char *copy = malloc(sizeof good_scene + strlen(text) + 2), *to = copy;
    const char *at = good_scene;
    for (int n = 1; *at; n++) {
        const char *end = strchr(at, '\n') + 1;
        to += n == line ? sprintf(to, "%s\n", text) : sprintf(to, "%.*s", (int)(end - at), at);
        at = end;
    }
    if (line == 0) sprintf(to, "%s\n", text);
    return copy;
}

static void expect_refusal(const struct bad_line *bad) {
    char *scene_text = with_line(bad->line, bad->text);
    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble = {0};
    scree_status status =
        scree_read_scene(scene_text, strlen(scene_text), "s.toml", NULL, 0, 0, &scene, &request, &trouble);
    CHECK(status == SCREE_BAD_INPUT || status == SCREE_NO_FILE);
    CHECK(scene == NULL);
    CONTAINS(trouble.text, bad->where);
    CONTAINS(trouble.text, bad->message);
    scree_scene_destroy(scene);
    scree_free_request(&request);
    free(scene_text);
}

static void expect_refusals(const struct bad_line *bad, size_t count) {
    for (size_t k = 0; k < count; k++) expect_refusal(&bad[k]);
}

/* Title, gravity, time. */
static void test_bad_head(void) {
    static const struct bad_line bad[] = {
        {1, "titel = \"t\"", "s.toml:1:1:", "unknown key \"titel\" in the scene; did you mean \"title\"?"},
        {1, "title = 5", "s.toml:1:9:", "title must be a string, not an integer"},
        {2, "gravity = [0, 0]", "s.toml:2:11:", "array of 3 numbers"},
        {2, "gravity = [0, 0, nan]", "s.toml:2:18:", "finite"},
        {2, "gravity = { vector = [0, 0, -9.81], axis = [0, 0, 0], tilt = \"m\" }",
         "s.toml:2:", "axis other than zero"},
        {2, "gravity = { vector = [0, 0, -9.81], tilt = \"n\" }",
         "s.toml:2:44:", "no motion called \"n\"; did you mean \"m\"?"},
        {2, "gravity = { vector = [0, 0, -9.81], axis = [0, 1, 0] }", "s.toml:2:44:", "add tilt"},
        {4, "end = -1", "s.toml:4:7:", "> 0"},
        {4, "end = inf", "s.toml:4:7:", "finite"},
        {4, "", "s.toml:3:", "[time] needs end"},
        {4, "end = 1e300", "s.toml:4:7:", "1e+305 steps of 1e-05 s; the most is 1e+15"},
        {5, "step = 1", "s.toml:5:8:", "beyond the stability limit of the stiffest contact"},
        {5, "step = 0", "s.toml:5:8:", "step must be > 0"},
        {5, "step = \"big\"", "s.toml:5:8:", "or \"auto\""},
        {5, "speed = 0", "s.toml:5:9:", "must be > 0 m/s"},
        {5, "speed = 1e300", "s.toml:5:9:", "beyond what numbers hold"},
        {5, "integrator = \"pair-impuls\"", "s.toml:5:14:", "did you mean \"pair-impulse\"?"},
        {5, "substeps = 2", "s.toml:5:12:", "must be asked for"},
        {5, "integrator = \"pair-impulse\"\nsubsteps = 0", "s.toml:6:12:", "whole number, 1 to 64"},
        {5, "threads = 1.5", "s.toml:5:11:", "whole number, 1 to 1024"},
        {5, "accuracy = 0.2", "s.toml:5:12:", "1e-6 to 0.1"},
        {5, "tolerance = 1e-9", "s.toml:5:13:", "goes with the integrator adaptive"},
        {5, "integrator = \"adaptive\"\ntolerance = 1e-2", "s.toml:6:13:", "1e-13 to 1e-3"},
        {5, "flight = true", "s.toml:5:10:", "without effect"},
        {5, "integrator = \"verlett\"", "s.toml:5:14:", "did you mean \"verlet\"?"},
    };
    expect_refusals(bad, sizeof bad / sizeof bad[0]);
}

/* Materials, contacts, motions. */
static void test_bad_laws_and_motions(void) {
    static const struct bad_line bad[] = {
        {7, "name = \"\"", "s.toml:7:8:", "needs a name"},
        {7, "name = \"a\\tb\"", "s.toml:7:8:", "without control characters"},
        {8, "density = -5", "s.toml:8:11:", "must be > 0 kg/m^3"},
        {8, "density = 0", "s.toml:8:11:", "must be > 0 kg/m^3"},
        {8, "density = \"heavy\"", "s.toml:8:11:", "must be a number"},
        {8, "densty = 5", "s.toml:8:1:", "did you mean \"density\"?"},
        {10, "between = [\"a\", \"b\"]", "s.toml:10:17:", "no material called \"b\""},
        {10, "between = \"a\"", "s.toml:10:11:", "between = ["},
        {11, "normal = { law = \"linaer\", stiffness = 1e4, damping = 0 }", "s.toml:11:", "did you mean \"linear\"?"},
        {11, "normal = { law = \"linear\", stiffness = -1, damping = 0 }", "s.toml:11:40:", "must be > 0"},
        {11, "normal = { law = \"linear\", stiffness = 1e4, restitution = 2 }", "s.toml:11:59:", "<= 1"},
        {11, "normal = { stiffness = 1e4, restitution = 0.5 }", "s.toml:11:", "needs a law"},
        {11, "normal = { lw = \"linear\", stiffness = 1e4 }",
         "s.toml:11:12:", "unknown key \"lw\" in normal; did you mean \"law\"?"},
        {11, "normal = { law = \"table\", ros = [[0, 0], [1e-4, 4]] }",
         "s.toml:11:27:", "unknown key \"ros\" in the law \"table\"; did you mean \"rows\"?"},
        {11, "normal = \"linear\"", "s.toml:11:10:", "must be a table"},
        {11, "", "s.toml:9:", "needs a normal law"},
        {12, "friction = { law = \"ramp\", kinetic = 0.3, treshold = 0.01 }",
         "s.toml:12:", "did you mean \"threshold\"?"},
        {13, "shared_by = 0.5", "s.toml:13:13:", "whole number"},
        {13, "shared_by = 0", "s.toml:13:13:", "whole number"},
        {15, "name = \"m\\u007f\"", "s.toml:15:8:", "without control characters"},
        {16, "kind = \"tabel\"", "s.toml:16:8:", "did you mean \"table\"?"},
        {16, "kid = \"table\"", "s.toml:16:1:", "unknown key \"kid\" in [[motion]]; did you mean \"kind\"?"},
        {16, "", "s.toml:14:", "needs a kind"},
        {16, "kind = \"table\"\noffset = 1",
         "s.toml:17:1:", "unknown key \"offset\" in a [[motion]] of kind \"table\""},
        {16, "kind = \"table\"\nvelocity = 1", "s.toml:17:1:", "of kind \"table\""},
        {16, "kind = \"sine\"", "s.toml:17:1:", "of kind \"sine\""},
        {17, "rows = [[0, 0], [0, 1]]", "s.toml:17:17:", "times of a motion table must increase: row 2"},
        {17, "rows = [[0, 0], [1, 1, 1]]", "s.toml:17:17:", "2 numbers like the first"},
        {17, "rows = [[0, 0]]", "s.toml:", "at least 2 rows"},
        {17, "file = \"missing.csv\"", "missing.csv:", "No such file"},
        {17, "rows = [[0, 0], [1, 1]]\ninterpolation = \"cubic\"", "s.toml:18:17:", "column of velocities"},
        {17, "velocity = 1", "s.toml:17:1:", "of kind \"table\""},
        {17, "file = \"-\"", "s.toml:17:8:", "standard input can't be one"},
        {17, "file = \"\"", "s.toml:17:8:", "must name a file"},
    };
    expect_refusals(bad, sizeof bad / sizeof bad[0]);
}

/* Bodies, output; tables behind them. */
static void test_bad_bodies(void) {
    static const struct bad_line bad[] = {
        {19, "name = \"o\\u0085\"", "s.toml:19:8:", "without control characters"},
        {19, "name = \"two\"", "s.toml:25:8:", "two of the body \"two\""},
        {20, "shape = { box = [0.1, 0.1, 0.1], rounding = 0.06 }", "s.toml:20:45:", "half its shortest edge"},
        {20, "shape = { box = [0.1, -0.1, 0.1] }", "s.toml:20:", "edge 2 of a box"},
        {20, "shape = { cube = 0.1 }", "s.toml:20:", "unknown key \"cube\""},
        {20, "shape = { sphere = 0.1, box = [1, 1, 1] }", "s.toml:20:", "just one of"},
        {20, "shape = { plane = false }", "s.toml:20:", "plane = true"},
        {21, "material = \"b\"", "s.toml:21:12:", "no material called \"b\""},
        {22, "position = [0, 0]", "s.toml:22:12:", "array of 3 numbers"},
        {22, "position = [0, 0, 0]\norientation = [0, 0, 0, 0]", "s.toml:23:", "must not be zero"},
        {22, "position = [0, 0, 0]\norientation = [1e-200, 1e-200, 0, 0]", "s.toml:23:", "no quaternion"},
        {22, "position = [0, 0, 0]\norientation = { axis = [0, 0, 0], angle = 1 }",
         "s.toml:23:15:", "must not be zero"},
        {22, "position = [0, 0, 0]\norientation = { axis = [1e200, 0, 0], angle = 1 }", "s.toml:23:15:", "to 1e100"},
        {23, "joint = \"fred\"", "s.toml:23:9:", "\"free\", \"fixed\""},
        {23, "joint = 3", "s.toml:23:9:", "unless it is a table { x, y, z, turn, others }, must be one of \"free\""},
        {23, "joint = { others = 5 }", "s.toml:23:20:", "others must be one of \"free\", \"fixed\""},
        {23, "joint = { turn = 5 }", "s.toml:23:18:", "turn is \"free\", \"fixed\", { hinge"},
        {23, "joint = { z = 5 }",
         "s.toml:23:15:", "z must be \"free\", \"fixed\" or the name of a motion, not an integer"},
        {23, "joint = { x = \"n\", others = \"fixed\" }", "s.toml:23:15:", "no motion called \"n\""},
        {23, "joint = { x = \"m\", others = \"fixed\" }\nvelocity = [1, 0, 0]",
         "s.toml:24:", "its joint fixes or drives"},
        {23, "joint = { turn = \"m\", others = \"fixed\" }", "s.toml:23:18:", "needs its axis"},
        {23, "joint = { turn = { hinge = [0, 0, 0] } }", "s.toml:23:28:", "hinge must not be zero"},
        {23, "joint = { turn = { hinge = [0, 0, 1], motion = \"nobody\" } }", "s.toml:23:18:", "either a hinge"},
        {23, "joint = { turn = { hinge = [0, 0, 1], axis = [0, 0, 1] } }", "s.toml:23:18:", "either a hinge"},
        {23, "joint = { turn = { hinge = [0, 0, 2] } }\nspin = [0, 1, 3]", "s.toml:24:8:", "isn't about the axis"},
        {26, "shape = { sphere = 0 }", "s.toml:26:", "positive length"},
        {26, "shape = { sphere = inf }", "s.toml:26:", "finite"},
        {28, "position = [0, 0, 0.05]", "s.toml:", "bodies \"two\" and \"one\" overlap by 0.1 m at the start"},
        {28, "position = [0, 0, 0.15]\nmass = 0", "s.toml:29:8:", "must be > 0 kg"},
        {28, "position = [0, 0, 0.15]\nmass = nan", "s.toml:29:8:", "finite"},
        {30, "every = 0", "s.toml:30:9:", "> 0 s"},
        {30, "every = 1e-300", "s.toml:30:9:", "closer than the step of 1e-05 s"},
        {31, "write = [\"body.csv\"]", "s.toml:31:10:", "did you mean \"bodies.csv\"?"},
        {31, "write = [\"energy\"]", "s.toml:31:10:", "did you mean \"energy.csv\"?"},
        {31, "write = [\"VTK\"]", "s.toml:31:10:", "did you mean \"vtk\"?"},
        {31, "write = []\nform = \"text\"",
         "s.toml:32:1:", "unknown key \"form\" in [output]; it has every, write, bodies"},
        {31, "write = []\nbodies = [\"three\"]", "s.toml:32:11:", "no body called \"three\""},
        {31, "bodies = []", "s.toml:31:10:", "would write none"},
        {0, "[[body]]\nname = \"x\"\nmaterial = \"a\"", "s.toml:32:1", "needs a shape"},
        {0, "[body]\n", "s.toml:32:", "is an array already"},
        {0, "[[contact]]\nbetween = [\"a\", \"a\"]\nnone = true", "s.toml:33:11:", "two contacts between"},
    };
    expect_refusals(bad, sizeof bad / sizeof bad[0]);
}

/* A scene that is right, and stays so by such a change: the bad ones fail for their own reasons. */
static void test_good_scene(void) {
    scree_scene_destroy(scene_from(good_scene, NULL, 0, 0));
    char *valid = with_line(9, "[[material]]\nname = \"c\"\n[[contact]]");
    scree_scene_destroy(scene_from(valid, NULL, 0, 0));
    free(valid);
}

/* A motion's kind without what moves it. */
static void test_motion_needs(void) {
    static const char *const kinds[][2] = {
        {"velocity", "needs velocity"}, {"rise", "needs stroke"}, {"sine", "needs amplitude"}};
    for (int k = 0; k < 3; k++) {
        char text[256];
        scree_scene *scene;
        struct scree_run_request request;
        scree_trouble trouble = {0};
        snprintf(text, sizeof text, "[time]\nend = 1.0\n[[motion]]\nname = \"m\"\nkind = \"%s\"\n", kinds[k][0]);
        CHECK(scree_read_scene(text, strlen(text), "s.toml", NULL, 0, 0, &scene, &request, &trouble) ==
              SCREE_BAD_INPUT);
        CONTAINS(trouble.text, "s.toml:3:1: ");
        CONTAINS(trouble.text, kinds[k][1]);
        scree_free_request(&request);
    }
}

/* A spin about the hinge, to rounding, is none off it. */
static void test_hinge(void) {
    char *text = with_line(23, "joint = { turn = { hinge = [0.1, 0.2, 0.7] } }\nspin = [0.3, 0.6, 2.1]");
    scree_scene_destroy(scene_from(text, NULL, 0, 0));
    free(text);
}

/* ---- motions and forces from a table in a file ---- */

/* What is said of the scene at `path`, "s.toml" beside the table "m.csv"; nothing: it is read. */
static void expect_with_table(const char *path, const char *text, const char *table, const char *message) {
    char of_table[64];
    snprintf(of_table, sizeof of_table, "%.*sm.csv", (int)(strlen(path) - strlen("s.toml")), path);
    FILE *file = fopen(of_table, "w");
    CHECK(file && fputs(table, file) >= 0 && fclose(file) == 0);
    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble = {0};
    scree_status status = scree_read_scene(text, strlen(text), path, NULL, 0, 0, &scene, &request, &trouble);
    CHECK(status == (message[0] ? SCREE_BAD_INPUT : SCREE_OK));
    CONTAINS(trouble.text, message);
    scree_scene_destroy(scene);
    scree_free_request(&request);
    CHECK(remove(of_table) == 0);
}

static void test_force_files(void) {
    static const char *const cases[][2] = {
        {"overlap_m,force_N\n0,0\n1e-3,10\n", ""},
        {"force_N,closing_m_s,overlap_m\n0,0,0\n1,1,0\n10,0,1e-3\n12,1,1e-3\n", ""},
        {"overlap_m,forse_N\n0,0\n1e-3,10\n",
         "m.csv:1:11: there is no column \"forse_N\" in a force table: it has overlap_m, force_N and, if wanted, "
         "closing_m_s; did you mean \"force_N\"?"},
        {"overlap_m,closing_m_s\n0,0\n1e-3,10\n", "m.csv:1:1: a force table needs the columns overlap_m and force_N"},
        {"overlap_m,force_N\n0,0\n0,10\n", "m.csv: the overlaps of a force table must rise: row 2 has 0 m after 0 m"}};
    char folder[] = "/tmp/scree-test-XXXXXX", path[64];
    CHECK(mkdtemp(folder) != NULL);
    snprintf(path, sizeof path, "%s/s.toml", folder);
    char *text = with_line(11, "normal = { law = \"table\", file = \"m.csv\" }");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) expect_with_table(path, text, cases[k][0], cases[k][1]);
    free(text);
    CHECK(remove(folder) == 0);
}

static void test_motion_files(void) {
    static const char *const cases[][2] = {
        {"time_ms,position_m\n0,0\n1,1\n",
         "m.csv:1:1: there is no column \"time_ms\" in a motion table: it has time_s"},
        {"angle_deg,position_m\n0,0\n1,1\n", "m.csv:1:1: a table over the machine's angle"},
        {"time_s, position_mm\n0,0\n1,1\n", "did you mean \"position_m\"?"},
        {"time,position,velocty\n0,0,0\n1,1,0\n", "m.csv:1:15: there is no column \"velocty\""},
        {"time,time_s,position\n0,0,0\n1,1,0\n", "m.csv:1:6: two columns for time"},
        {"# c\ntime,velocity\n0,0\n1,1\n", "m.csv:2:1: the table needs the columns"},
        {"time,position,acceleration\n0,0,0\n1,1,0\n", "m.csv:1:1: the acceleration of a motion counts only beside"},
        {"time,position\n0,0\n", "m.csv: a motion needs at least 2 rows"},
        {"# c\ntime,position\n0,0\n# c\n0,1\n", "m.csv:5:1: time must increase: 0 after 0"},
        {"time_s,position_m,velocity_rad_s\n0,0,0\n1,1,0\n",
         "m.csv:1:19: \"velocity_rad_s\" goes by rad, and a column before it by m"},
        {"time_s,position_rad\n0,0\n1,1\n", "s.toml:23:15: the motion \"m\" is in rad, and x goes by m"},
        {"\xef\xbb\xbf\"time_s\",\"position_m\"\n0,0\n1,1\n", ""},
        {"time,position\n0,0\n1,1\n", ""}};
    /* What goes by rad: line, text, and what is said of a table in m. */
    static const struct {
        int line;
        const char *text, *message;
    } turns[] = {{2, "gravity = { vector = [0, 0, -9.81], axis = [0, 1, 0], tilt = \"m\" }",
                  "s.toml:2:62: the motion \"m\" is in m, and a tilt goes by rad"},
                 {23, "joint = { turn = { axis = [0, 0, 1], motion = \"m\" }, others = \"fixed\" }",
                  "s.toml:23:47: the motion \"m\" is in m, and a turn"}};
    char folder[] = "/tmp/scree-test-XXXXXX", path[64];
    CHECK(mkdtemp(folder) != NULL);
    snprintf(path, sizeof path, "%s/s.toml", folder);
    char *text = with_line(17, "file = \"m.csv\"");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) expect_with_table(path, text, cases[k][0], cases[k][1]);
    free(text);
    for (size_t k = 0; k < sizeof turns / sizeof turns[0]; k++) {
        char *whole = with_line(turns[k].line, turns[k].text), *rows = strstr(whole, "rows = [[0, 0], [1, 1]]");
        memcpy(rows, "file = \"m.csv\"         ", 23);
        expect_with_table(path, whole, "time_s,position_m\n0,0\n1,1\n", turns[k].message);
        free(whole);
    }
    CHECK(remove(folder) == 0);
}

/* ---- messages ---- */

/* What a message says of a scene whose body has no mass. */
static void report_with(const char *body, const char *path, scree_trouble *trouble) {
    size_t size = strlen(body) + 512;
    char *text = malloc(size);
    snprintf(text, size,
             "[time]\nend = 1.0\n[[material]]\nname = \"m\"\n[[body]]\nname = \"%s\"\nmaterial = \"m\"\n"
             "shape = { sphere = 1.0 }\n",
             body);
    scree_scene *scene;
    struct scree_run_request request;
    CHECK(scree_read_scene(text, strlen(text), path, NULL, 0, 0, &scene, &request, trouble) == SCREE_BAD_INPUT);
    scree_free_request(&request);
    free(text);
}

static void test_messages(void) {
    static const char cause[] = "has no mass: give it one (kg), or its material \"m\" a density (kg/m^3)";
    scree_trouble trouble;
    report_with("a\\nb\\u001b[31m\\u009b", "s.toml", &trouble); /* line feed, escape, and escape's one-byte sister */
    CONTAINS(trouble.text, "s.toml:6:8: the name of a body is one line without control characters, not "
                           "\"a\\nb\\x1b[31m\\x9b\"");
    CHECK(!strpbrk(trouble.text, "\n\x1b"));

    char *name = repeat("start-", "n\xc3\xa9", 80, "-end"), *path = repeat("/", "folder/", 500, "s.toml");
    char *longer = repeat("start-", "n\xc3\xa9", 2000, "-end");
    report_with(longer, path, &trouble); /* 6010 bytes of name, 3507 of path */
    CONTAINS(trouble.text, "folder/s.toml:6:8: the name of a body has at most 255 bytes, \"start-n");
    CONTAINS(trouble.text, "\xe2\x80\xa6"); /* … */
    CONTAINS(trouble.text, "-end\" has 6010");
    CHECK(strlen(trouble.text) < sizeof trouble.text);
    char *alien = repeat("", "\x80", 1000, ""); /* not UTF-8: no byte begins a character */
    report_with("a", alien, &trouble);
    CONTAINS(trouble.text, "\x80\xe2\x80\xa6\x80");
    CONTAINS(trouble.text, cause);
    free(alien);
    report_with(name, "s.toml", &trouble); /* 250 bytes */
    CONTAINS(trouble.text, "s.toml:5:1: body \"start-n");
    CONTAINS(trouble.text, "-end\" ");
    CONTAINS(trouble.text, cause);
    report_with("short", path, &trouble);
    CONTAINS(trouble.text, "folder/s.toml:5:1: body \"short\" ");
    CONTAINS(trouble.text, cause);
    report_with(name, path, &trouble);
    CONTAINS(trouble.text, cause);
    CHECK(strlen(trouble.text) < sizeof trouble.text);
    CHECK(strlen(scree_shown(name).text) < 100 && strcmp(scree_shown("a\tb\x7f").text, "a\\tb\\x7f") == 0);

    const char *const known[] = {"stiffness", NULL};
    CHECK(scree_hint(name, known).text[0] == '\0'); /* whatever its length, it is no misspelling of that */
    free(path);
    free(longer);
    free(name);

    /* A value that was set from outside stands nowhere in the file. */
    const char *set = "body.two.shape={sphere = 0.1, rounding = 0.01}";
    scree_scene *scene;
    struct scree_run_request request;
    CHECK(scree_read_scene(good_scene, strlen(good_scene), "s.toml", &set, 1, 0, &scene, &request, &trouble) ==
          SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "s.toml with body.two.shape={sphere = 0.1, rounding = 0.01}: only a box has a rounding");
    scree_free_request(&request);

    struct scree_toml_document document;
    CHECK(parse("\xef\xbb\xbf"
                "a = 1.",
                &document, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "t.toml:1:5: ");
    scree_toml_free(&document);
}

/* The same scene from a file and from C gives the same bits. */
static void test_file_and_c(void) {
    scree_scene *from_file = scene_from(good_scene, NULL, 0, 0), *from_c = scree_scene_create();
    int a, m;
    double times[] = {0.0, 1.0}, positions[] = {0.0, 1.0};
    CHECK(!scree_scene_add_material(from_c, &(scree_material_def){.name = "a", .density = 1000.0}, &a));
    CHECK(!scree_scene_add_contact(
        from_c, &(scree_contact_def){.between = {a, a},
                                     .normal = {"linear", 2, {{"stiffness", 1e4}, {"restitution", 0.5}}},
                                     .friction = {"ramp", 2, {{"kinetic", 0.3}, {"threshold", 0.01}}}}));
    CHECK(!scree_scene_add_motion(
        from_c,
        &(scree_motion_def){.name = "m", .kind = SCREE_MOTION_TABLE, .rows = 2, .times = times, .positions = positions},
        &m));
    CHECK(!scree_scene_set_gravity(from_c, &(scree_gravity_def){.vector = {0.0, 0.0, -9.81}}));
    CHECK(!scree_scene_set_time(from_c, &(scree_time_def){.step = 1e-5}));
    scree_body_def one = {
        .name = "one",
        .shape = {.kind = SCREE_BOX, .edge = {0.1, 0.1, 0.1}, .rounding = 0.01},
        .material = a,
        .joint = {.along = {SCREE_DRIVEN, SCREE_FIXED, SCREE_FIXED}, .turn = SCREE_FIXED, .along_motion = {m, 0, 0}}};
    scree_body_def two = {
        .name = "two", .shape = {.kind = SCREE_SPHERE, .radius = 0.1}, .material = a, .position = {0, 0, 0.15}};
    CHECK(!scree_scene_add_body(from_c, &one, NULL) && !scree_scene_add_body(from_c, &two, NULL));
    CHECK(!scree_scene_bake(from_c));
    go(from_file, 3000);
    go(from_c, 3000);
    CHECK(scree_scene_hash(from_file) == scree_scene_hash(from_c));
    CHECK(scree_scene_deepest(from_c, NULL, NULL) > 0.0);
    scree_scene_destroy(from_file);
    scree_scene_destroy(from_c);
}

/* A host program's locale with a decimal comma changes nothing. */
static void test_locale(void) {
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"};
    const char *set = NULL;
    for (int k = 0; k < 3 && !set; k++) set = setlocale(LC_ALL, names[k]);
    if (!set) printf("(no locale with a decimal comma is installed: locale test skipped)\n");
    scree_scene *scene = scene_from(good_scene, NULL, 0, 0);
    CHECK(scree_scene_step_length(scene) == 1e-5);
    scree_scene_destroy(scene);
    setlocale(LC_ALL, "C");
}

/* ---- measured forces ---- */

static scree_status read_forces(const char *rest, scree_trouble *trouble, double *force) {
    char text[1024];
    snprintf(text, sizeof text,
             "[time]\nend = 1.0\nstep = 1e-5\n[[material]]\nname = \"m\"\ndensity = 1000\n"
             "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"table\"%s }\n"
             "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
             "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = 0.01 }\nposition = [0, 0, 0.00995]\n",
             rest);
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_status status = scree_read_scene(text, strlen(text), "t.toml", NULL, 0, 0, &scene, &request, trouble);
    scree_contact_state contact;
    int count = 0;
    if (!status) CHECK(scree_scene_contacts(scene, &contact, 1, &count) == SCREE_OK && count == 1);
    if (!status) *force = contact.normal_force;
    scree_scene_destroy(scene);
    scree_free_request(&request);
    return status;
}

static void test_force_tables(void) {
    scree_trouble trouble;
    double force = 0.0;
    CHECK(read_forces(", rows = [[0, 0], [1e-4, 4.0]]", &trouble, &force) == SCREE_OK);
    NEAR(force, 2.0, 1e-12); /* an overlap of 50 um, given to 1e-18 m of 1e-2 */
    CHECK(read_forces(", rows = [[0, 0, 0], [0, 1, 1], [1e-4, 0, 6.0], [1e-4, 1, 9]]", &trouble, &force) == SCREE_OK);
    NEAR(force, 3.0, 1e-12);
    static const char *const bad[][2] = {
        {"", "needs either rows"},
        {", rows = [[0, 0], [1e-4, 4.0]], file = \"x.csv\"", "needs either rows"},
        {", rows = [[0, 0]]", "must form a grid"},
        {", rows = [[0, 0, 0], [0, 1, 1], [1e-4, 0, 6.0]]", "must form a grid"},
        {", rows = [[0, 0], [1e-4]]", "must have 2 numbers"},
        {", rows = [[0, 1], [1e-4, 4]]", "must begin at overlap 0"},
        {", rows = [[0, 0], [1e-4, 4], [1e-4, 5]]", "must rise"},
        {", file = \"missing.csv\"", "t.toml:9:34: missing.csv: No such file"},
        {", rows = [[0, 0], [1e-4, 4]], stiffness = 3.0", "unknown key \"stiffness\" in the law \"table\""},
    };
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        CHECK(read_forces(bad[k][0], &trouble, &force) == SCREE_BAD_INPUT || trouble.status == SCREE_NO_FILE);
        CONTAINS(trouble.text, bad[k][1]);
    }
}

int main(void) {
    test_accepted();
    test_refused();
    test_monsters();
    test_tables();
    test_good_scene();
    test_bad_head();
    test_bad_laws_and_motions();
    test_bad_bodies();
    test_motion_needs();
    test_hinge();
    test_force_files();
    test_motion_files();
    test_messages();
    test_file_and_c();
    test_locale();
    test_force_tables();
    return check_report();
}
