/* Student's distribution by its finite series in the angle atan(t/sqrt(freedom)). */
#include "solver/student.h"

#include <math.h>

/* P(|T| <= sqrt(freedom) tan(angle)): Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 26.7.3 for odd
 * and 26.7.4 for even degrees of freedom. */
static double within(double angle, long freedom) {
    const double two_over_pi = 0.63661977236758134308;
    double sine = sin(angle), cosine = cos(angle), squared = cosine * cosine;
    int odd = freedom % 2 == 1;
    double term = odd ? cosine : 1.0, sum = 0.0;
    for (long k = odd ? 3 : 2; k <= freedom; k += 2) {
        double next = sum + term;
        if (next == sum) break;
        sum = next;
        term *= squared * (double)(k - 1) / (double)k;
    }
    return odd ? two_over_pi * (angle + sine * sum) : sine * sum;
}

double scree_student_bound(double confidence, long freedom) {
    if (!(confidence > 0.0 && confidence < 1.0) || freedom < 1) return NAN;
    double low = 0.0, high = 1.57079632679489661923;
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        if (within(middle, freedom) < confidence)
            low = middle;
        else
            high = middle;
    }
    return sqrt((double)freedom) * tan(high);
}
