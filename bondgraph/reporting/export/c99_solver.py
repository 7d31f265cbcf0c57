"""The solver inside an exported C program, as C text.

Dense LU with partial pivoting, for unknowns that enter linearly; Newton's method around
it for others. ``MODEL`` stands for the name of the model.
"""

FACTOR = """\
enum { N = MODEL_n_unknowns };

/* LU factors of a with partial pivoting, in place; 0 if a is singular. */
static int factor(double a[], int pivot[])
{
    int i, j, k;
    for (k = 0; k < N; ++k) {
        int best = k;
        for (i = k + 1; i < N; ++i)
            if (fabs(a[i*N + k]) > fabs(a[best*N + k]))
                best = i;
        pivot[k] = best;
        if (!(fabs(a[best*N + k]) > 1e-300))
            return 0;
        for (j = 0; best != k && j < N; ++j) {
            const double swapped = a[k*N + j];
            a[k*N + j] = a[best*N + j];
            a[best*N + j] = swapped;
        }
        for (i = k + 1; i < N; ++i) {
            a[i*N + k] /= a[k*N + k];
            for (j = k + 1; j < N; ++j)
                a[i*N + j] -= a[i*N + k] * a[k*N + j];
        }
    }
    return 1;
}

/* Solve a s = b in place, after factor. */
static void substitute(const double a[], const int pivot[], double b[])
{
    int i, k;
    for (k = 0; k < N; ++k) {
        const double swapped = b[k];
        b[k] = b[pivot[k]];
        b[pivot[k]] = swapped;
    }
    for (k = 0; k < N; ++k)
        for (i = k + 1; i < N; ++i)
            b[i] -= a[i*N + k] * b[k];
    for (k = N - 1; k >= 0; --k) {
        b[k] /= a[k*N + k];
        for (i = 0; i < k; ++i)
            b[i] -= a[i*N + k] * b[k];
    }
}

"""

LINEAR = """\
/* The residuals are linear in z: one step from zero solves them. */
static int solve(double t, const double x[], const double u[],
    const MODEL_parameters *p, double z[])
{
    double r[N], J[N*N];
    int i, pivot[N];
    for (i = 0; i < N; ++i)
        z[i] = 0.0;
    residuals(t, x, u, p, z, r, J);
    if (!factor(J, pivot))
        return MODEL_singular;
    substitute(J, pivot, r);
    for (i = 0; i < N; ++i) {
        z[i] = -r[i];
        if (!isfinite(z[i]))
            return MODEL_not_finite;
    }
    return MODEL_ok;
}
"""

NEWTON = """\
/* The largest change in a step, relative to the size of its unknown. */
static double size_of(const double step[], const double weight[])
{
    double size = 0.0;
    int i;
    for (i = 0; i < N; ++i) {
        if (!isfinite(step[i]))
            return HUGE_VAL;
        size = fmax(size, fabs(step[i]) / weight[i]);
    }
    return size;
}

/* Newton's method. A step is halved until the next one, taken with the same Jacobian,
 * is shorter (Deuflhard, Newton Methods for Nonlinear Problems, 2004, section 3.1). */
static int solve(double t, const double x[], const double u[],
    const MODEL_parameters *p, double z[])
{
    double r[N], J[N*N], step[N], trial[N], weight[N];
    double last = HUGE_VAL;
    int i, iteration, pivot[N];
    for (i = 0; i < N; ++i)
        weight[i] = 1e-6;
    for (iteration = 0; iteration < 100; ++iteration) {
        double size, damping = 1.0;
        residuals(t, x, u, p, z, step, J);
        if (!factor(J, pivot)) {
            if (iteration > 0)
                return MODEL_singular;
            for (i = 0; i < N; ++i) /* flat at the start: look a little further */
                z[i] += 1e-3 * (1.0 + i);
            continue;
        }
        substitute(J, pivot, step);
        for (i = 0; i < N; ++i)
            weight[i] = fmax(weight[i], fabs(z[i]));
        size = size_of(step, weight);
        if (!isfinite(size))
            return MODEL_not_finite;
        for (;;) {
            for (i = 0; i < N; ++i)
                trial[i] = z[i] - damping * step[i];
            if (size <= 1e-12)
                break;
            residuals(t, x, u, p, trial, r, NULL);
            substitute(J, pivot, r);
            if (size_of(r, weight) <= (1.0 - 0.25 * damping) * size || damping < 1e-4)
                break;
            damping *= 0.5;
        }
        for (i = 0; i < N; ++i)
            z[i] = trial[i];
        /* Steps that no longer shrink are rounding. */
        if (size <= 1e-12 || (size <= 1e-6 && size >= 0.5 * last))
            return MODEL_ok;
        last = size;
    }
    return MODEL_not_converged;
}
"""
