/* Student's distribution: how wide a confidence interval is. */
#ifndef SCREE_SOLVER_STUDENT_H
#define SCREE_SOLVER_STUDENT_H

/* The t of which |T| <= t has the probability `confidence`, 0 < confidence < 1, where T has Student's distribution
 * (Biometrika 6 (1908) 1) with `freedom` >= 1 degrees of freedom; NAN for anything else. */
double scree_student_bound(double confidence, long freedom);

#endif
