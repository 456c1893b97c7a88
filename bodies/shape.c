/* Shapes: checks, volume, inertia, bounds. */
#include "bodies/shape.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

const char *scree_shape_name(scree_shape_kind kind) {
    static const char *const names[SCREE_SHAPE_KINDS] = {"sphere", "box", "plane", "rectangle"};
    return names[kind];
}

static double shortest_edge(const scree_shape *box) { return fmin(box->edge[0], fmin(box->edge[1], box->edge[2])); }

static scree_status check_edges(const scree_shape *shape, int count, scree_trouble *trouble) {
    for (int k = 0; k < count; k++)
        if (!(shape->edge[k] > 0.0) || !isfinite(shape->edge[k]))
            return scree_report(trouble, SCREE_BAD_INPUT, "shape",
                                "edge %d of a %s must be a positive length in m, got %g", k + 1,
                                scree_shape_name(shape->kind), shape->edge[k]);
    return SCREE_OK;
}

scree_status scree_shape_check(const scree_shape *shape, scree_trouble *trouble) {
    switch (shape->kind) {
    case SCREE_SPHERE:
        if (shape->radius > 0.0 && isfinite(shape->radius)) return SCREE_OK;
        return scree_report(trouble, SCREE_BAD_INPUT, "shape",
                            "the radius of a sphere must be a positive length in m, got %g", shape->radius);
    case SCREE_BOX: {
        scree_status status = check_edges(shape, 3, trouble);
        if (status) return status;
        if (shape->rounding >= 0.0 && shape->rounding <= 0.5 * shortest_edge(shape)) return SCREE_OK;
        return scree_report(trouble, SCREE_BAD_INPUT, "shape.rounding",
                            "the rounding of this box must lie between 0 and half its shortest edge (%g m), got %g",
                            0.5 * shortest_edge(shape), shape->rounding);
    }
    case SCREE_PLANE:
        return SCREE_OK;
    case SCREE_RECTANGLE:
        return check_edges(shape, 2, trouble);
    case SCREE_SHAPE_KINDS:
        break;
    }
    return scree_report(trouble, SCREE_BAD_INPUT, "shape", "there is no shape of kind %d", (int)shape->kind);
}

double scree_shape_volume(const scree_shape *shape) {
    double r = shape->radius;
    if (shape->kind == SCREE_SPHERE) return 4.0 / 3.0 * pi * r * r * r;
    if (shape->kind != SCREE_BOX) return 0.0;
    r = shape->rounding;
    double a = shape->edge[0] - 2.0 * r, b = shape->edge[1] - 2.0 * r, c = shape->edge[2] - 2.0 * r;
    return a * b * c + 2.0 * r * (a * b + b * c + c * a) + pi * r * r * (a + b + c) + 4.0 / 3.0 * pi * r * r * r;
}

/* Integral of x^2 over a rounded box whose core has edges a (along x), b, c and whose rounding is r: the core and
 * its slabs, the edges along x, those along y and z, and the corners, each by the moments of half, quarter and
 * eighth of a disc or ball about their flat sides. */
static double second_moment(double a, double b, double c, double r) {
    double h = 0.5 * a, r2 = r * r, r3 = r2 * r, r4 = r3 * r;
    double core = a * a * a / 12.0 * (b * c + 2.0 * r * (b + c));
    double slabs = 2.0 / 3.0 * b * c * ((h + r) * (h + r) * (h + r) - h * h * h);
    double edges_along = a * a * a / 12.0 * pi * r2;
    double edges_across = (b + c) * (h * h * pi * r2 + h * 8.0 / 3.0 * r3 + 0.25 * pi * r4);
    double corners = h * h * 4.0 / 3.0 * pi * r3 + h * pi * r4 + 4.0 / 15.0 * pi * r4 * r;
    return core + slabs + edges_along + edges_across + corners;
}

void scree_shape_inertia(const scree_shape *shape, double moments[3]) {
    moments[0] = moments[1] = moments[2] = 0.0;
    if (shape->kind == SCREE_SPHERE) moments[0] = moments[1] = moments[2] = 0.4 * shape->radius * shape->radius;
    if (shape->kind != SCREE_BOX) return;
    double r = shape->rounding, volume = scree_shape_volume(shape);
    double a = shape->edge[0] - 2.0 * r, b = shape->edge[1] - 2.0 * r, c = shape->edge[2] - 2.0 * r;
    double xx = second_moment(a, b, c, r) / volume;
    double yy = second_moment(b, c, a, r) / volume;
    double zz = second_moment(c, a, b, r) / volume;
    moments[0] = yy + zz;
    moments[1] = zz + xx;
    moments[2] = xx + yy;
}

double scree_shape_bound(const scree_shape *shape) {
    if (shape->kind == SCREE_SPHERE) return shape->radius;
    if (shape->kind == SCREE_PLANE) return HUGE_VAL;
    double r = shape->kind == SCREE_BOX ? shape->rounding : 0.0;
    double a = 0.5 * shape->edge[0] - r, b = 0.5 * shape->edge[1] - r;
    double c = shape->kind == SCREE_BOX ? 0.5 * shape->edge[2] - r : 0.0;
    return sqrt(a * a + b * b + c * c) + r;
}

double scree_shape_half_width(const scree_shape *shape) {
    if (shape->kind == SCREE_SPHERE) return shape->radius;
    if (shape->kind == SCREE_BOX) return 0.5 * shortest_edge(shape);
    return HUGE_VAL;
}
