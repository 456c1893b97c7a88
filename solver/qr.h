/* Dense least squares for small problems: Householder QR with column pivoting, and the trust-region step by the secular
 * equation. Matrices are stored by columns. No allocation, no state. */
#ifndef SCREE_SOLVER_QR_H
#define SCREE_SOLVER_QR_H

/* Euclidean norm, safe against overflow and underflow. */
double scree_norm(int count, const double *x);

/* The power of two that brings x to [0.5, 1) in size (1 for zero, infinity and NaN): multiplying by it costs no
 * digits. */
double scree_binary_unit(double x);

/* Inner product; four partial sums in a fixed order, which the compiler can keep in one register. */
double scree_dot(int count, const double *x, const double *y);

/* Factor `a` (rows x columns, rows >= 1) as A P = Q R (Golub & Van Loan, Matrix Computations, algorithm 5.4.1, Businger
 * & Golub 1965). Afterwards the columns of `a` hold the Householder vectors on and below their diagonal and R above it;
 * `diagonal` holds R's diagonal (min(rows, columns) entries, |diagonal| falling), `pivot[j]` the column of A that
 * became column j, `norms` the norms of A's columns. `work` has `columns` entries. */
void scree_qr_factor(int rows, int columns, double *a, int *pivot, double *diagonal, double *norms, double *work);

/* b <- Q^T b for a factored `a`. */
void scree_qr_transform(int rows, int columns, const double *a, double *b);

/* Copy R into an n x n array by columns, its lower triangle zero (rows >= columns = n). */
void scree_qr_triangle(int rows, int columns, const double *a, const double *diagonal, double *r);

/* Number of leading columns of R whose diagonal entry is larger than `tolerance` times their norm: the sine of the
 * angle between the column and those before it, so the units of the unknowns don't count. `norms` and `pivot` are those
 * of the factorisation. */
int scree_qr_rank(int columns, const double *diagonal, const int *pivot, const double *norms, double tolerance);

/* The step p that minimises |J p + f| within |D p| <= radius, for J P = Q R and b = -(Q^T f): either the Gauss-Newton
 * step, or that of (J^T J + par D^2) p = -J^T f with |D p| within a tenth of the radius (More 1978: Newton's iteration
 * on the secular equation 1/radius - 1/|D p(par)|, safeguarded). `par` holds the last value on entry and the new one on
 * return. `r` (n x n) and `b` stay as they are; `work` has n (n + 4) entries. Returns |D p|. */
double scree_qr_trust_step(int n, const double *r, const int *pivot, const double *d, const double *b, double radius,
                           double *par, double *p, double *work);

/* Solve (J^T J + par D^2) p = J^T f for one `par` >= 0 (as above; no radius). Singular directions of R get 0 where par
 * = 0. */
void scree_qr_damped_solve(int n, const double *r, const int *pivot, const double *d, const double *b, double par,
                           double *p, double *work);

#endif
