/* scree impact: two bodies meet; what laws make of it, side by side, over a sweep. */
#include "contact/ask.h"
#include "engine/cli/cli.h"
#include "engine/cli/figures.h"
#include "engine/cli/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: scree impact --law \"NAME KEY=NUMBER …\" [--law …] [--friction \"NAME KEY=NUMBER …\"] [OPTION …]\n"
    "\n"
    "Two bodies meet at one point, apart from any scene, integrated to about ten digits: restitution, rebound, spins, "
    "contact\n"
    "time, largest overlap and forces, energy lost. `scree laws` names laws and parameters. Laws that are given "
    "several times\n"
    "stand side by side, every normal law with every friction law.\n"
    "\n"
    "  --law \"NAME …\"       normal law (up to 8)\n"
    "  --friction \"NAME …\"  friction law (up to 8; default: frictionless)\n"
    "  --ball \"SHAPE …\"     the body that comes: sphere radius= or box x= y= z= [rounding= tilt_x= tilt_y=] (m, "
    "degrees: meets\n"
    "                       with its lowest corner), each with mass= (kg) or density= (kg/m^3), and young= (Pa) "
    "poisson=\n"
    "                       for laws that take their stiffness from the materials; default: sphere radius=0.01 "
    "density=2500\n"
    "  --host \"SHAPE …\"     what it meets: plane [young= poisson=] (default; rigid), or a sphere as above, at rest\n"
    "  --speed V            of the ball's centre, m/s (default: 1)\n"
    "  --angle A            between that velocity and the normal, degrees, 0 … below 90 (default: 0)\n"
    "  --spin W             of the ball, rad/s; > 0 as if it rolled the way it flies (default: 0)\n"
    "  --host-spin W        of the host, about the same axis (default: 0)\n"
    "  --sweep NAME=FROM:TO:COUNT[:log]\n"
    "                       speed, angle, spin, host-spin, law.KEY, friction.KEY, ball.KEY or host.KEY in COUNT "
    "values\n"
    "  --want KEY=E         print the value of each law's parameter KEY (a damping) that delivers the restitution E "
    "for these\n"
    "                       bodies at this speed, found by integration to 1e-10\n"
    "  --loop               without -o: print the force-overlap loop instead of the results\n"
    "  -o DIR               write impact.csv and loop.csv (the loop at the values that aren't swept), and plots of "
    "both, into\n"
    "                       DIR; without it results are printed\n"
    "\n"
    "Angles of rebound are those of the centre and of the contact point. e_tangential compares the centres, slip_ratio "
    "the\n"
    "contact points (tangential speed after over that before; < 0: turned round). Exit status 1 if some impacts are "
    "left\n"
    "unfinished: their laws are too steep, or numbers too large or too small, to be followed.\n"
    "\n"
    "example: scree impact --ball \"sphere radius=0.0025 density=4000 young=3.8e11 poisson=0.23\" --speed 3.9 \\\n"
    "           --law \"tsuji-cut restitution=0.98\" --friction \"mindlin static=0.092 kinetic=0.092\" \\\n"
    "           --friction \"mindlin-incremental static=0.092 kinetic=0.092\" --sweep angle=1:85:85 -o impact\n";

enum { MOST_LAWS = 8, MOST_POINTS = 100000 };

/* What may be swept apart from numbers of laws and bodies. */
enum { SPEED, ANGLE, SPIN, HOST_SPIN, QUANTITIES };
static const char *const quantities[QUANTITIES] = {"speed", "angle", "spin", "host-spin"};

struct sweep {
    char name[64];   /* as given */
    const char *key; /* after the point, into name; NULL: a quantity */
    double from, to;
    int count, by_ratio;
};

struct setting {
    struct words ball, host, law[MOST_LAWS], friction[MOST_LAWS];
    double quantity[QUANTITIES];
    int laws, frictions;
    struct sweep sweep;
    int unfinished; /* some impacts couldn't be followed */
    int unplotted;  /* plots that gnuplot failed on */
    double deepest; /* overlap over half a half-width, the largest of all */
    scree_trouble trouble;
};

/* One impact, ready to be computed. */
struct impact {
    double quantity[QUANTITIES];
    struct scree_encounter encounter;
    struct scree_rule rule;
    double limit; /* half a half-width, m: a scene that goes deeper is stopped */
};

/* ---- reading ---- */

static int read_number(const char *text, const char *option, double *value) {
    char *end;
    if (!text) return EXIT_GOOD;
    *value = strtod(text, &end);
    if (!*text || *end || !isfinite(*value)) return cli_complain("%s takes a number, not \"%s\"", option, text);
    return EXIT_GOOD;
}

static int read_sweep(const char *text, struct sweep *sweep) {
    char ratio[8] = "", after = '\0';
    double points = 0.0;
    *sweep = (struct sweep){.count = 1};
    if (!text) return EXIT_GOOD;
    int read = sscanf(text, "%63[^=]=%lf:%lf:%lf:%7s%c", sweep->name, &sweep->from, &sweep->to, &points, ratio, &after);
    sweep->by_ratio = strcmp(ratio, "log") == 0;
    if ((read != 4 && !(read == 5 && sweep->by_ratio)) || text[strlen(text) - 1] == ':')
        return cli_complain("--sweep takes NAME=FROM:TO:COUNT or NAME=FROM:TO:COUNT:log, not \"%s\"", text);
    if (!(points >= 2.0 && points <= MOST_POINTS && points == floor(points)))
        return cli_complain("--sweep %s: COUNT must be a whole number from 2 to %d", sweep->name, MOST_POINTS);
    sweep->count = (int)points;
    if (!isfinite(sweep->from) || !isfinite(sweep->to) || sweep->from == sweep->to)
        return cli_complain("--sweep %s: FROM and TO must be two numbers", sweep->name);
    if (sweep->by_ratio && !(sweep->from > 0.0 && sweep->to > 0.0))
        return cli_complain("--sweep %s: values by ratio (log) must be > 0", sweep->name);
    char *point = strchr(sweep->name, '.');
    static const char *const names[] = {"speed",        "angle",    "spin",     "host-spin", "law.KEY",
                                        "friction.KEY", "ball.KEY", "host.KEY", NULL};
    size_t length = point ? (size_t)(point - sweep->name) : strlen(sweep->name);
    for (int k = 0; names[k]; k++) {
        const char *dot = strchr(names[k], '.');
        size_t own = dot ? (size_t)(dot - names[k]) : strlen(names[k]);
        if (!dot == !point && own == length && strncmp(names[k], sweep->name, length) == 0) {
            sweep->key = point ? point + 1 : NULL;
            return EXIT_GOOD;
        }
    }
    return cli_complain("--sweep: there is no \"%s\" to sweep (speed, angle, spin, host-spin, law.KEY, friction.KEY, "
                        "ball.KEY, host.KEY)%s",
                        sweep->name, scree_hint(sweep->name, names).text);
}

static double swept_value(const struct sweep *sweep, int point) {
    double share = (double)point / (sweep->count - 1);
    if (point == 0) return sweep->from;
    if (point == sweep->count - 1) return sweep->to;
    return sweep->by_ratio ? sweep->from * pow(sweep->to / sweep->from, share)
                           : sweep->from + share * (sweep->to - sweep->from);
}

/* ---- making one impact ---- */

static scree_status bake(struct setting *s, const struct words *law, const struct words *friction,
                         const struct words_body body[2], struct scree_rule *rule) {
    double young[2] = {body[0].young, body[1].young}, poisson[2] = {body[0].poisson, body[1].poisson};
    struct scree_elastic elastic = scree_elastic_of(young, poisson);
    scree_contact_def def = {.between = {0, 1}};
    scree_status status = words_law(law, &def.normal, &s->trouble);
    if (!status && friction) status = words_law(friction, &def.friction, &s->trouble);
    return status ? status : scree_bake_rule(&def, &elastic, rule, &s->trouble);
}

/* A sharp corner has no radius for laws that need one. */
static scree_status check_radius(struct setting *s, const struct impact *impact, double mass) {
    const struct scree_rule *rule = &impact->rule;
    const struct scree_normal_law *law = scree_normal_laws[rule->normal];
    struct scree_pair_constants sharp = law->pair(&rule->normal_constants, mass, 0.0);
    struct scree_pair_constants round = law->pair(&rule->normal_constants, mass, 1.0);
    if (impact->encounter.radius > 0.0 || memcmp(&sharp, &round, sizeof sharp) == 0) return SCREE_OK;
    return scree_report(&s->trouble, SCREE_BAD_INPUT, "--ball",
                        "the law \"%s\" takes its stiffness from the radius of the corner: give the box a rounding",
                        law->text.name);
}

static scree_status check_motion(struct setting *s, const struct scree_encounter *e,
                                 const double quantity[QUANTITIES]) {
    if (!(quantity[SPEED] > 0.0))
        return scree_report(&s->trouble, SCREE_BAD_INPUT, "--speed", "the speed must be > 0, got %g m/s",
                            quantity[SPEED]);
    if (!(quantity[ANGLE] >= 0.0 && quantity[ANGLE] < 90.0))
        return scree_report(&s->trouble, SCREE_BAD_INPUT, "--angle",
                            "the angle is between velocity and normal, 0 … below 90 degrees, got %g", quantity[ANGLE]);
    if (!(-vec_dot(scree_approach(e), e->normal) > 0.0))
        return scree_report(&s->trouble, SCREE_BAD_INPUT, "--spin",
                            "the points of contact don't approach each other: the spin carries the corner away");
    return SCREE_OK;
}

static double limit_of(const struct words_body body[2]) {
    return 0.5 * fmin(scree_shape_half_width(&body[0].shape), scree_shape_half_width(&body[1].shape));
}

static void put_in_place(const struct words_body body[2], const double quantity[QUANTITIES],
                         struct scree_encounter *e) {
    double angle = quantity[ANGLE] * 3.14159265358979323846 / 180.0, speed = quantity[SPEED];
    double first = body[0].shape.kind == SCREE_SPHERE ? body[0].shape.radius : body[0].shape.rounding;
    double other = body[1].shape.radius;
    *e = (struct scree_encounter){.normal = {0.0, 0.0, 1.0}};
    e->radius = body[1].shape.kind == SCREE_SPHERE && first > 0.0 ? first * other / (first + other) : first;
    e->ball = scree_partner_of(&body[0].shape, body[0].mass, body[0].attitude, vec(0.0, 0.0, -1.0));
    e->host = scree_partner_of(&body[1].shape, body[1].mass, body[1].attitude, vec(0.0, 0.0, 1.0));
    e->ball.velocity = vec(speed * sin(angle), 0.0, -speed * cos(angle));
    e->ball.spin.y = quantity[SPIN];
    e->host.spin.y = quantity[HOST_SPIN];
}

/* Case `n` (of laws x frictions) at a point of the sweep; point -1: nothing is swept. */
static scree_status make_impact(struct setting *s, int n, int point, struct impact *impact) {
    struct words part[4] = {s->ball, s->host, s->law[n / (s->frictions ? s->frictions : 1)], {.name = NULL}};
    static const char *const prefix[4] = {"ball.", "host.", "law.", "friction."};
    double *quantity = impact->quantity;
    scree_status status = SCREE_OK;
    if (s->frictions) part[3] = s->friction[n % s->frictions];
    memcpy(quantity, s->quantity, sizeof s->quantity);
    if (point >= 0 && s->sweep.key) {
        for (int k = 0; k < 4 && !status; k++)
            if (strncmp(s->sweep.name, prefix[k], strlen(prefix[k])) == 0)
                status = words_with(&part[k], s->sweep.key, swept_value(&s->sweep, point), &part[k], &s->trouble);
    } else if (point >= 0) {
        for (int k = 0; k < QUANTITIES; k++)
            if (strcmp(s->sweep.name, quantities[k]) == 0) quantity[k] = swept_value(&s->sweep, point);
    }
    struct words_body body[2];
    if (!status) status = words_body(&part[0], "--ball", &body[0], &s->trouble);
    if (!status) status = words_body(&part[1], "--host", &body[1], &s->trouble);
    if (!status && body[0].shape.kind == SCREE_PLANE)
        status = scree_report(&s->trouble, SCREE_BAD_INPUT, "--ball", "--ball: a plane can't move; give it as --host");
    if (!status && body[1].shape.kind == SCREE_BOX)
        status = scree_report(&s->trouble, SCREE_BAD_INPUT, "--host",
                              "--host is a plane or a sphere; give the box as --ball");
    if (!status) status = bake(s, &part[2], s->frictions ? &part[3] : NULL, body, &impact->rule);
    if (status) return status;
    put_in_place(body, quantity, &impact->encounter);
    impact->limit = limit_of(body);
    status = check_radius(s, impact, body[0].mass);
    return status ? status : check_motion(s, &impact->encounter, quantity);
}

static int cases(const struct setting *s) { return s->laws * (s->frictions ? s->frictions : 1); }

/* ---- results ---- */

/* Unit of the swept number as part of a column's name: "" where there is none, or laws differ. */
static void swept_unit(const struct setting *s, char unit[32]) {
    static const char *const of_bodies[][2] = {{"mass", "kg"},   {"density", "kg_m3"}, {"young", "Pa"},
                                               {"poisson", "1"}, {"tilt_x", "deg"},    {"tilt_y", "deg"}};
    const char *found = "1";
    if (strncmp(s->sweep.name, "ball.", 5) == 0 || strncmp(s->sweep.name, "host.", 5) == 0) {
        found = "m";
        for (size_t k = 0; k < sizeof of_bodies / sizeof of_bodies[0]; k++)
            if (strcmp(s->sweep.key, of_bodies[k][0]) == 0) found = of_bodies[k][1];
    } else {
        int normal = strncmp(s->sweep.name, "law.", 4) == 0, count = normal ? s->laws : s->frictions;
        for (int k = 0; k < count; k++) {
            int index = normal ? scree_find_normal_law(s->law[k].name) : scree_find_friction_law(s->friction[k].name);
            const struct scree_law_text *text =
                normal ? &scree_normal_laws[index]->text : &scree_friction_laws[index]->text;
            for (const struct scree_parameter *p = text->parameters; p->name; p++)
                if (strcmp(p->name, s->sweep.key) == 0) found = k > 0 && strcmp(found, p->unit) != 0 ? "1" : p->unit;
        }
    }
    snprintf(unit, 32, "%s%s", strcmp(found, "1") ? "_" : "", strcmp(found, "1") ? found : "");
    for (char *c = unit; *c; c++)
        if (*c == '/' || *c == ' ') *c = '_';
}

/* A swept number that isn't among the columns anyway comes third. */
static void print_header(const struct setting *s, FILE *file) {
    char unit[32] = "";
    fprintf(file, "law,friction,");
    if (s->sweep.key) swept_unit(s, unit);
    if (s->sweep.key) fprintf(file, "%s%s,", s->sweep.name, unit);
    fprintf(file,
            "speed_m_s,angle_deg,spin_rad_s,host_spin_rad_s,restitution,e_tangential,slip_ratio,rebound_angle_deg,"
            "contact_rebound_angle_deg,spin_after_rad_s,host_spin_after_rad_s,duration_s,overlap_m,force_N,"
            "friction_force_N,energy_J,lost_normal_J,lost_tangential_J,ending\n");
}

static const char *law_name(const struct scree_rule *rule) { return scree_normal_laws[rule->normal]->text.name; }

static const char *friction_name(const struct scree_rule *rule) {
    return rule->friction >= 0 ? scree_friction_laws[rule->friction]->text.name : "none";
}

/* Velocity of the ball against the host: of centres, or of the points of contact. */
static struct vec relative(const struct scree_partner *ball, const struct scree_partner *host, int contact) {
    struct scree_encounter e = {.ball = *ball, .host = *host};
    return contact ? scree_approach(&e) : vec_sub(ball->velocity, host->velocity);
}

static void print_ratio(FILE *file, double value, double by) {
    if (by == 0.0)
        fprintf(file, ",");
    else
        fprintf(file, "%.17g,", value / by);
}

/* Of an impact that couldn't be followed nothing is printed that comes of it. */
static void print_row(struct setting *s, int point, const struct impact *impact, FILE *file) {
    static const char *const endings[] = {"parted", "stayed", "unfinished"};
    const struct scree_encounter *e = &impact->encounter;
    struct scree_outcome_of_impact after = scree_meet(e, &impact->rule, NULL, NULL);
    struct vec slip = relative(&e->ball, &e->host, 1), slip_after = relative(&after.ball, &after.host, 1);
    struct vec moves = relative(&e->ball, &e->host, 0), moves_after = relative(&after.ball, &after.host, 0);
    double degrees = 180.0 / 3.14159265358979323846;
    fprintf(file, "%s,%s,", law_name(&impact->rule), friction_name(&impact->rule));
    if (s->sweep.key) fprintf(file, "%.17g,", point >= 0 ? swept_value(&s->sweep, point) : NAN);
    for (int k = 0; k < QUANTITIES; k++) fprintf(file, "%.17g,", impact->quantity[k]);
    if (after.ending == SCREE_UNFINISHED) {
        fprintf(file, ",,,,,,,,,,,%.17g,,,%s\n", after.energy, endings[after.ending]);
        s->unfinished = 1;
        return;
    }
    fprintf(file, "%.17g,", after.restitution);
    print_ratio(file, moves_after.x, moves.x);
    print_ratio(file, slip_after.x, slip.x);
    fprintf(file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%s\n",
            atan2(moves_after.x, moves_after.z) * degrees, atan2(slip_after.x, slip_after.z) * degrees,
            after.ball.spin.y, after.host.spin.y, after.duration, after.deepest, after.force, after.friction,
            after.energy, after.lost_normal, after.lost_tangential, endings[after.ending]);
    s->deepest = fmax(s->deepest, after.deepest / impact->limit);
}

/* Whatever is wrong is said before anything is printed. */
static scree_status check_all(struct setting *s, int points) {
    scree_status status = SCREE_OK;
    for (int n = 0; n < cases(s); n++)
        for (int point = points ? 0 : -1; point < points && !status; point++) {
            struct impact impact;
            status = make_impact(s, n, point, &impact);
        }
    return status;
}

/* All results, a block per case. */
static scree_status print_results(struct setting *s, FILE *file) {
    int points = s->sweep.name[0] ? s->sweep.count : 0;
    scree_status status = check_all(s, points);
    if (status) return status;
    print_header(s, file);
    for (int n = 0; n < cases(s); n++) {
        for (int point = points ? 0 : -1; point < points; point++) {
            struct impact impact;
            status = make_impact(s, n, point, &impact);
            if (status) return status;
            print_row(s, point, &impact, file);
        }
        if (n + 1 < cases(s)) fprintf(file, "\n\n");
    }
    return SCREE_OK;
}

struct loop {
    FILE *file;
    const struct scree_rule *rule;
};

static void print_moment(void *context, const struct scree_moment *m) {
    const struct loop *loop = context;
    fprintf(loop->file, "%s,%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", law_name(loop->rule), friction_name(loop->rule),
            m->time, m->overlap, m->closing, m->force, m->slip.x, m->friction.x);
}

/* Force-overlap loops at the values that aren't swept, a block per case. */
static scree_status print_loops(struct setting *s, FILE *file) {
    int given = !check_all(s, 0); /* else a number that only the sweep gives comes from its first value */
    scree_status checked = given ? SCREE_OK : s->sweep.key ? check_all(s, 1) : s->trouble.status;
    if (checked) return checked;
    fprintf(file, "law,friction,time_s,overlap_m,closing_m_s,force_N,slip_m_s,friction_N\n");
    for (int n = 0; n < cases(s); n++) {
        struct impact impact;
        scree_status status = make_impact(s, n, given ? -1 : 0, &impact);
        if (status) return status;
        struct loop loop = {file, &impact.rule};
        s->unfinished |= scree_meet(&impact.encounter, &impact.rule, print_moment, &loop).ending == SCREE_UNFINISHED;
        if (n + 1 < cases(s)) fprintf(file, "\n\n");
    }
    return SCREE_OK;
}

/* ---- the folder ---- */

static scree_status write_table(struct setting *s, struct figures *figures, const char *name,
                                scree_status (*print)(struct setting *s, FILE *file)) {
    struct scree_out out = {0};
    scree_status status = figures_open(figures, name, &out);
    if (status) {
        s->trouble = figures->trouble;
        return status;
    }
    status = print(s, out.file);
    if (status) {
        scree_out_drop(&out, 0);
        return status;
    }
    status = scree_out_keep(&out, &figures->trouble);
    if (status) s->trouble = figures->trouble;
    return status;
}

/* 'name of case 1', 'name of case 2' … as a gnuplot array. */
static void print_titles(const struct setting *s, char *text, size_t size) {
    size_t length = (size_t)snprintf(text, size, "array titles[%d]\n", cases(s));
    for (int n = 0; n < cases(s) && length < size; n++) {
        const char *friction = s->frictions ? s->friction[n % s->frictions].name : "";
        const char *law = s->law[n / (s->frictions ? s->frictions : 1)].name;
        length += (size_t)snprintf(text + length, size - length, "titles[%d] = '%s%s%s'\n", n + 1, law,
                                   s->frictions ? ", " : "", friction);
    }
}

/* Two panels over the swept quantity: columns of impact.csv, counted without the one of a swept KEY. */
static scree_status plot_results(const struct setting *s, struct figures *figures) {
    char titles[4096], script[8192], x[128];
    int over_angle = strcmp(s->sweep.name, "angle") == 0, shift = s->sweep.key ? 1 : 0, column = 3;
    int upper = over_angle ? 8 : 7, lower = s->frictions ? 10 : 14;
    static const char *const units[QUANTITIES] = {"m/s", "degrees", "rad/s", "rad/s"};
    snprintf(x, sizeof x, "%s", s->sweep.name);
    for (int k = 0; k < QUANTITIES; k++) {
        if (strcmp(s->sweep.name, quantities[k]) != 0) continue;
        snprintf(x, sizeof x, "%s (%s)", s->sweep.name, units[k]);
        column = 3 + k;
    }
    print_titles(s, titles, sizeof titles);
    snprintf(
        script, sizeof script,
        "unset datafile columnheaders\n%s%sset xlabel '%s' noenhanced\nset key above maxcols 2 noenhanced font ',10'\n"
        "set multiplot layout 2,1\n"
        "set ylabel '%s'\n"
        "plot for [k=1:%d] 'impact.csv' index k-1 using %d:%d with lines ls (k-1)%%7+1 title titles[k]\n"
        "unset key\nset ylabel '%s'\n"
        "plot for [k=1:%d] 'impact.csv' index k-1 using %d:%d with lines ls (k-1)%%7+1\n"
        "unset multiplot\n",
        titles, s->sweep.by_ratio ? "set logscale x\n" : "", x, over_angle ? "{e_t} of the centre" : "restitution",
        cases(s), column, upper + shift, s->frictions ? "angle of rebound (degrees)" : "contact time (s)", cases(s),
        column, lower + shift);
    return figures_plot(figures, "impact", script);
}

static scree_status plot_loops(const struct setting *s, struct figures *figures) {
    char titles[4096], script[8192];
    print_titles(s, titles, sizeof titles);
    snprintf(script, sizeof script,
             "unset datafile columnheaders\n%sset xlabel 'overlap (um)'\nset ylabel 'normal force (N)'\nset key "
             "outside right top noenhanced font ',8'\n"
             "plot for [k=1:%d] 'loop.csv' index k-1 using ($4*1e6):6 with lines ls (k-1)%%7+1 title titles[k]\n",
             titles, cases(s));
    return figures_plot(figures, "loop", script);
}

static scree_status write_folder(struct setting *s, const char *folder) {
    struct figures figures = {.folder = folder, .plots = 1};
    scree_status status = scree_make_folder(folder, &s->trouble);
    if (!status) status = write_table(s, &figures, "impact", print_results);
    if (!status) status = write_table(s, &figures, "loop", print_loops);
    if (status) return status;
    if (s->sweep.name[0]) status = plot_results(s, &figures);
    if (!status) status = plot_loops(s, &figures);
    if (status) s->trouble = figures.trouble;
    if (!status) printf("written to %s\n", folder);
    if (!status) s->unplotted = figures_unplotted(&figures);
    return status;
}

/* ---- asked for ---- */

/* The value of a law's parameter at which the bodies part with the wanted restitution. */
static scree_status print_wanted(struct setting *s, const char *key, double restitution, FILE *file) {
    struct words_body body[2];
    scree_status status = words_body(&s->ball, "--ball", &body[0], &s->trouble);
    if (!status) status = words_body(&s->host, "--host", &body[1], &s->trouble);
    if (!status && (body[0].shape.kind != SCREE_SPHERE || body[1].shape.kind == SCREE_BOX))
        status = scree_report(&s->trouble, SCREE_BAD_INPUT, "--want", "--want is for a sphere on a plane or a sphere");
    if (status) return status;
    double m = body[0].mass, other = body[1].mass, r = body[0].shape.radius;
    double young[2] = {body[0].young, body[1].young}, poisson[2] = {body[0].poisson, body[1].poisson};
    struct scree_elastic elastic = scree_elastic_of(young, poisson);
    struct scree_wish wish = {.restitution = restitution, .speed = s->quantity[SPEED], .tolerance = 1e-10};
    wish.mass = other > 0.0 ? m * other / (m + other) : m;
    wish.radius = body[1].shape.kind == SCREE_SPHERE ? r * body[1].shape.radius / (r + body[1].shape.radius) : r;
    for (int k = 0; k < s->laws; k++) {
        scree_law_choice choice = {0};
        double value = NAN;
        status = words_law(&s->law[k], &choice, &s->trouble);
        if (!status) status = scree_ask(&choice, &elastic, key, &wish, &value, &s->trouble);
        if (status) return status;
        if (k == 0) fprintf(file, "law,restitution,speed_m_s,parameter,value\n");
        fprintf(file, "%s,%.17g,%.17g,%s,%.17g\n", s->law[k].name, restitution, wish.speed, key, value);
    }
    return SCREE_OK;
}

/* KEY=E into its parts. */
static int read_want(const char *text, char key[64], double *restitution) {
    char rest;
    if (sscanf(text, "%63[^=]=%lf%c", key, restitution, &rest) == 2 && *restitution > 0.0 && *restitution <= 1.0)
        return EXIT_GOOD;
    return cli_complain("--want takes KEY=E, a parameter and a restitution above 0 and at most 1, not \"%s\"", text);
}

/* ---- the command ---- */

static int read_laws(const char *const *text, int count, const char *option, struct words *words,
                     scree_trouble *trouble) {
    int is_law = strcmp(option, "--law") == 0;
    for (int k = 0; k < count; k++) {
        int bad = words_read(&words[k], text[k], option, trouble) != SCREE_OK;
        if (is_law && words[k].name && strcmp(words[k].name, "table") == 0)
            return cli_complain("%s: only a scene file can give the law \"table\" its measured forces", option);
        if (bad) return cli_complain("%s", trouble->text);
    }
    return EXIT_GOOD;
}

int cli_impact(int count, char **words) {
    struct setting s = {.quantity = {[SPEED] = 1.0}};
    const char *law[MOST_LAWS], *friction[MOST_LAWS], *folder = NULL, *sweep = NULL, *want = NULL;
    const char *quantity[QUANTITIES] = {0};
    const char *ball = "sphere radius=0.01 density=2500", *host = "plane";
    int loop = 0, sweeps = 0;
    const struct cli_option options[] = {
        {.name = "--law", .list = law, .list_count = &s.laws, .list_capacity = MOST_LAWS},
        {.name = "--friction", .list = friction, .list_count = &s.frictions, .list_capacity = MOST_LAWS},
        {.name = "--ball", .value = &ball},
        {.name = "--host", .value = &host},
        {.name = "--speed", .value = &quantity[SPEED]},
        {.name = "--angle", .value = &quantity[ANGLE]},
        {.name = "--spin", .value = &quantity[SPIN]},
        {.name = "--host-spin", .value = &quantity[HOST_SPIN]},
        {.name = "--sweep", .list = &sweep, .list_count = &sweeps, .list_capacity = 1},
        {.name = "--want", .value = &want},
        {.name = "--loop", .flag = &loop},
        {.name = "-o", .value = &folder},
        {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (count) return cli_complain("impact takes options only, not \"%s\" (see scree impact --help)", words[0]);
    if (!s.laws) return cli_complain("impact needs a normal law: --law \"NAME KEY=NUMBER …\" (see scree laws)");
    static const char *const names[QUANTITIES] = {"--speed", "--angle", "--spin", "--host-spin"};
    for (int k = 0; k < QUANTITIES && !code; k++) code = read_number(quantity[k], names[k], &s.quantity[k]);
    if (!code) code = read_sweep(sweep, &s.sweep);
    if (!code) code = read_laws(law, s.laws, "--law", s.law, &s.trouble);
    if (!code) code = read_laws(friction, s.frictions, "--friction", s.friction, &s.trouble);
    if (!code) code = read_laws(&ball, 1, "--ball", &s.ball, &s.trouble);
    if (!code) code = read_laws(&host, 1, "--host", &s.host, &s.trouble);
    if (code) return code;
    if (s.sweep.key && strncmp(s.sweep.name, "friction.", 9) == 0 && !s.frictions)
        return cli_complain("--sweep %s: there is no --friction", s.sweep.name);
    if (want && (s.frictions || sweep || loop || folder || quantity[ANGLE] || quantity[SPIN] || quantity[HOST_SPIN]))
        return cli_complain("--want goes with --law, --ball, --host and --speed only");
    char key[64];
    double restitution = 1.0;
    if (want && read_want(want, key, &restitution)) return EXIT_USAGE;
    scree_status status = want     ? print_wanted(&s, key, restitution, stdout)
                          : folder ? write_folder(&s, folder)
                          : loop   ? print_loops(&s, stdout)
                                   : print_results(&s, stdout);
    if (status) cli_complain("%s", s.trouble.text);
    if (!status && s.unfinished)
        cli_complain("what is unfinished can't be followed: its laws are too steep, or numbers too large or too small");
    if (!status && s.deepest > 1.0)
        cli_complain("the largest overlap is %.3g times half a half-width of the body: a scene would be stopped there",
                     s.deepest);
    return status ? cli_exit_code(status) : s.unfinished || s.unplotted ? EXIT_MISSED : EXIT_GOOD;
}
