/* Closed forms for scree-bench precision and the tests of the orders. */
#include "bench/precision.h"

#include <math.h>

/* Slip s and its speed u under a spring of rate q^2 and a pull (m/s^2). */
struct slip {
    double s, u;
};

static struct slip swing(struct slip at, double q, double pull, double time) {
    double middle = pull / (q * q), away = at.s - middle, c = cos(q * time), n = sin(q * time);
    return (struct slip){middle + away * c + at.u / q * n, at.u * c - away * q * n};
}

void precision_roll(const struct precision_ball *ball, double numbers[3]) {
    double load = ball->mass * ball->gravity * cos(ball->alpha), down = ball->gravity * sin(ball->alpha);
    double arm = ball->radius - 0.5 * load / ball->k, inertia = 0.4 * ball->mass * ball->radius * ball->radius;
    double yield = 1.0 / ball->mass + arm * arm / inertia, q = sqrt(ball->k_t * yield);
    double limit = ball->mu * load, stretch = limit / ball->k_t, left = ball->time;
    struct slip at = {0.0, ball->speed};
    double slipped = 0.0; /* of the contact point, m */

    /* The spring first: until it is stretched to the limit. */
    double middle = down / (q * q), size = hypot(middle, at.u / q), sticking = left;
    if (middle + size > stretch) {
        double begin = atan2(at.u / q, -middle); /* s = middle + size cos(q t - begin) */
        sticking = (begin - acos((stretch - middle) / size)) / q;
        if (sticking > left) sticking = left;
    }
    struct slip now = swing(at, q, down, sticking);
    slipped += now.s - at.s;
    left -= sticking;
    /* Then the limit, until the slip ends; if it does, the spring again, which carries less from then on. */
    double slowing = limit * yield - down, sliding = slowing > 0.0 ? fmin(left, now.u / slowing) : left;
    if (left > 0.0) {
        slipped += now.u * sliding - 0.5 * slowing * sliding * sliding;
        now.u -= slowing * sliding;
        left -= sliding;
    }
    if (left > 0.0) {
        struct slip then = swing((struct slip){stretch, 0.0}, q, down, left);
        slipped += then.s - stretch;
        now.u = then.u;
    }
    /* Slip and what the pull alone would make tell the impulse and its moment: u = u0 + g t - yield J. */
    double impulse = (ball->speed + down * ball->time - now.u) / yield;
    double moment = (ball->speed * ball->time + 0.5 * down * ball->time * ball->time - slipped) / yield;
    numbers[0] = ball->speed * ball->time + 0.5 * down * ball->time * ball->time - moment / ball->mass;
    numbers[1] = ball->speed + down * ball->time - impulse / ball->mass;
    numbers[2] = ball->radius * impulse * arm / inertia;
}

/* Overlap and closing speed, `time` after a touch at `speed`. */
static void press(double gravity, double omega, double zeta, double speed, double time, double *overlap,
                  double *closing) {
    double root = sqrt(1.0 - zeta * zeta), turn = omega * root, decay = zeta * omega, rest = gravity / (omega * omega);
    double a = -rest, b = (speed + decay * a) / turn, c = cos(turn * time), s = sin(turn * time);
    double shrunk = exp(-decay * time);
    *overlap = rest + shrunk * (a * c + b * s);
    *closing = shrunk * ((b * turn - decay * a) * c - (a * turn + decay * b) * s);
}

/* When it lets go again, s after touch; INFINITY: never (it would be within the turn). */
static double letting_go(double gravity, double omega, double zeta, double speed) {
    double turn = omega * sqrt(1.0 - zeta * zeta), step = 6e-3 / turn, overlap, closing;
    double low = 0.0, high = 1.5707963267948966 / turn;
    do {
        low = high;
        high += step;
        if (low > 6.2831853071795865 / turn) return INFINITY;
        press(gravity, omega, zeta, speed, high, &overlap, &closing);
    } while (overlap > 0.0);
    for (int n = 0; n < 80; n++) {
        double middle = 0.5 * (low + high);
        press(gravity, omega, zeta, speed, middle, &overlap, &closing);
        if (overlap < 0.0)
            high = middle;
        else
            low = middle;
    }
    return high;
}

int precision_bounce(double mass, double gravity, double k, double zeta, double speed, double time, double numbers[2]) {
    double omega = sqrt(k / mass), overlap, closing;
    for (int bounces = 0;; bounces++) {
        double touching = letting_go(gravity, omega, zeta, speed);
        press(gravity, omega, zeta, speed, fmin(time, touching), &overlap, &closing);
        numbers[0] = -overlap;
        numbers[1] = -closing;
        if (time < touching) return bounces;
        time -= touching;
        speed = -closing;
        numbers[0] = speed * time - 0.5 * gravity * time * time;
        numbers[1] = speed - gravity * time;
        if (numbers[0] >= 0.0) return bounces + 1;
        time -= 2.0 * speed / gravity;
    }
}
