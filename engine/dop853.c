/* Dormand-Prince 8(5,3). */
#include "engine/dop853.h"

#include <math.h>
#include <stdlib.h>

/* Coefficients a[stage][earlier stage]; the nodes are the sums of the rows. */
static const double a[SCREE_DOP853_STAGES][SCREE_DOP853_STAGES - 1] = {
    {0.0},
    {5.26001519587677318785587544488e-2},
    {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
    {2.95875854768068491816892993775e-2, 0.0, 8.87627564304205475450678981324e-2},
    {2.41365134159266685502369798665e-1, 0.0, -8.84549479328286085344864962717e-1, 9.24834003261792003115737966543e-1},
    {3.7037037037037037037037037037e-2, 0.0, 0.0, 1.70828608729473871279604482173e-1,
     1.25467687566822425016691814123e-1},
    {3.7109375e-2, 0.0, 0.0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2, -1.7578125e-2},
    {3.70920001185047927108779319836e-2, 0.0, 0.0, 1.70383925712239993810214054705e-1,
     1.07262030446373284651809199168e-1, -1.53194377486244017527936158236e-2, 8.27378916381402288758473766002e-3},
    {6.24110958716075717114429577812e-1, 0.0, 0.0, -3.36089262944694129406857109825,
     -8.68219346841726006818189891453e-1, 2.75920996994467083049415600797e+1, 2.01540675504778934086186788979e+1,
     -4.34898841810699588477366255144e+1},
    {4.77662536438264365890433908527e-1, 0.0, 0.0, -2.48811461997166764192642586468,
     -5.90290826836842996371446475743e-1, 2.12300514481811942347288949897e+1, 1.52792336328824235832596922938e+1,
     -3.32882109689848629194453265587e+1, -2.03312017085086261358222928593e-2},
    {-9.3714243008598732571704021658e-1, 0.0, 0.0, 5.18637242884406370830023853209, 1.09143734899672957818500254654,
     -8.14978701074692612513997267357, -1.85200656599969598641566180701e+1, 2.27394870993505042818970056734e+1,
     2.49360555267965238987089396762, -3.0467644718982195003823669022},
    {2.27331014751653820792359768449, 0.0, 0.0, -1.05344954667372501984066689879e+1, -2.00087205822486249909675718444,
     -1.79589318631187989172765950534e+1, 2.79488845294199600508499808837e+1, -2.85899827713502369474065508674,
     -8.87285693353062954433549289258, 1.23605671757943030647266201528e+1, 6.43392746015763530355970484046e-1}};

static const double b[SCREE_DOP853_STAGES] = {5.42937341165687622380535766363e-2,
                                              0.0,
                                              0.0,
                                              0.0,
                                              0.0,
                                              4.45031289275240888144113950566,
                                              1.89151789931450038304281599044,
                                              -5.8012039600105847814672114227,
                                              3.1116436695781989440891606237e-1,
                                              -1.52160949662516078556178806805e-1,
                                              2.01365400804030348374776537501e-1,
                                              4.47106157277725905176885569043e-2};

/* Order 5: the estimate itself. */
static const double e5[SCREE_DOP853_STAGES] = {0.1312004499419488073250102996e-1,
                                               0.0,
                                               0.0,
                                               0.0,
                                               0.0,
                                               -0.1225156446376204440720569753e+1,
                                               -0.4957589496572501915214079952,
                                               0.1664377182454986536961530415e+1,
                                               -0.3503288487499736816886487290,
                                               0.3341791187130174790297318841,
                                               0.8192320648511571246570742613e-1,
                                               -0.2235530786388629525884427845e-1};

/* Order 3: a formula of that order, whose difference to b is the estimate. */
static const double third[3] = {0.244094488188976377952755905512, 0.733846688281611857341361741547,
                                0.220588235294117647058823529412e-1};

int scree_dop853_resize(struct scree_dop853 *work, size_t size) {
    work->size = size;
    if (size <= work->capacity) return 0;
    size_t capacity = size + size / 2;
    double *memory = calloc(capacity * (SCREE_DOP853_STAGES + 4), sizeof *memory);
    if (!memory) return -1;
    free(work->memory);
    work->memory = memory;
    work->capacity = capacity;
    for (int s = 0; s < SCREE_DOP853_STAGES; s++) work->k[s] = memory + (size_t)s * capacity;
    memory += SCREE_DOP853_STAGES * capacity;
    work->stage = memory;
    work->end = memory + capacity;
    work->error5 = memory + 2 * capacity;
    work->error3 = memory + 3 * capacity;
    return 0;
}

void scree_dop853_free(struct scree_dop853 *work) {
    free(work->memory);
    *work = (struct scree_dop853){0};
}

enum { BLOCK = 64 }; /* sums are made by blocks, so that they stay in registers and cache and take wide instructions */

/* sum = weights . k over one block of unknowns, in the order of the stages; weights of zero are left out. */
static void combine(double *restrict sum, const double *weights, int stages, double *const *k, size_t from,
                    size_t count) {
    for (size_t i = 0; i < count; i++) sum[i] = weights[0] * k[0][from + i];
    for (int s = 1; s < stages; s++) {
        const double *rates = k[s] + from;
        double weight = weights[s];
        if (weight == 0.0) continue;
        for (size_t i = 0; i < count; i++) sum[i] += weight * rates[i];
    }
}

void scree_dop853_step(struct scree_dop853 *work, scree_dop853_rates *rates, void *context, const double *y, double h) {
    double **k = work->k, sum[BLOCK], wrong[BLOCK];
    for (int s = 1; s < SCREE_DOP853_STAGES; s++) {
        for (size_t from = 0; from < work->size; from += BLOCK) {
            size_t count = work->size - from < BLOCK ? work->size - from : BLOCK;
            combine(sum, a[s], s, k, from, count);
            for (size_t i = 0; i < count; i++) work->stage[from + i] = y[from + i] + h * sum[i];
        }
        rates(context, work->stage, k[s]);
    }
    for (size_t from = 0; from < work->size; from += BLOCK) {
        size_t count = work->size - from < BLOCK ? work->size - from : BLOCK;
        combine(sum, b, SCREE_DOP853_STAGES, k, from, count);
        combine(wrong, e5, SCREE_DOP853_STAGES, k, from, count);
        for (size_t i = 0; i < count; i++) {
            double low = third[0] * k[0][from + i] + third[1] * k[8][from + i] + third[2] * k[11][from + i];
            work->end[from + i] = y[from + i] + h * sum[i];
            work->error5[from + i] = h * wrong[i];
            work->error3[from + i] = h * (sum[i] - low);
        }
    }
}

double scree_dop853_error(double error5, double error3) {
    double square = error5 * error5, both = square + 0.01 * error3 * error3;
    return both == 0.0 ? 0.0 : square / sqrt(both); /* a NaN stays one */
}
