/* dop853.c - the explicit method of order 8 of Dormand and Prince, with error control.
 *
 * Twelve evaluations a step; a thirteenth at the new state is the first of the next step. Two
 * errors are combined: E5, the distance from a method of order 5, and E3, from one of order 3
 * with the nodes 1, 9 and 12 (nystrom.c). Their combination falls as h^8. Steps that contact
 * and not the error limits are taken by dopri5 (nystrom.c).
 *
 * Coefficients: Prince, Dormand 1981; Hairer, Norsett, Wanner 1993, sec. II.10 and the errors
 * of its appendix. Rounded to the double nearest. */
#include "high_order_methods.h"

enum { STAGES = 13 };

// clang-format off
static const double nodes[STAGES] = {
    0, 0.526001519587677318785587544488E-01, 0.789002279381515978178381316732E-01,
    0.118350341907227396726757197510, 0.281649658092772603273242802490, 1.0 / 3, 0.25,
    4.0 / 13, 127.0 / 195, 0.6, 6.0 / 7, 1, 1};
static const double table[STAGES][NYSTROM_STAGES] = {
    {0},
    {[0] = 5.26001519587677318785587544488E-2},
    {[0] = 1.97250569845378994544595329183E-2, [1] = 5.91751709536136983633785987549E-2},
    {[0] = 2.95875854768068491816892993775E-2, [2] = 8.87627564304205475450678981324E-2},
    {[0] = 2.41365134159266685502369798665E-1, [2] = -8.84549479328286085344864962717E-1,
     [3] = 9.24834003261792003115737966543E-1},
    {[0] = 3.7037037037037037037037037037E-2, [3] = 1.70828608729473871279604482173E-1,
     [4] = 1.25467687566822425016691814123E-1},
    {[0] = 3.7109375E-2, [3] = 1.70252211019544039314978060272E-1,
     [4] = 6.02165389804559606850219397283E-2, [5] = -1.7578125E-2},
    {[0] = 3.70920001185047927108779319836E-2, [3] = 1.70383925712239993810214054705E-1,
     [4] = 1.07262030446373284651809199168E-1, [5] = -1.53194377486244017527936158236E-2,
     [6] = 8.27378916381402288758473766002E-3},
    {[0] = 6.24110958716075717114429577812E-1, [3] = -3.36089262944694129406857109825E0,
     [4] = -8.68219346841726006818189891453E-1, [5] = 2.75920996994467083049415600797E1,
     [6] = 2.01540675504778934086186788979E1, [7] = -4.34898841810699588477366255144E1},
    {[0] = 4.77662536438264365890433908527E-1, [3] = -2.48811461997166764192642586468E0,
     [4] = -5.90290826836842996371446475743E-1, [5] = 2.12300514481811942347288949897E1,
     [6] = 1.52792336328824235832596922938E1, [7] = -3.32882109689848629194453265587E1,
     [8] = -2.03312017085086261358222928593E-2},
    {[0] = -9.3714243008598732571704021658E-1, [3] = 5.18637242884406370830023853209E0,
     [4] = 1.09143734899672957818500254654E0, [5] = -8.14978701074692612513997267357E0,
     [6] = -1.85200656599969598641566180701E1, [7] = 2.27394870993505042818970056734E1,
     [8] = 2.49360555267965238987089396762E0, [9] = -3.0467644718982195003823669022E0},
    {[0] = 2.27331014751653820792359768449E0, [3] = -1.05344954667372501984066689879E1,
     [4] = -2.00087205822486249909675718444E0, [5] = -1.79589318631187989172765950534E1,
     [6] = 2.79488845294199600508499808837E1, [7] = -2.85899827713502369474065508674E0,
     [8] = -8.87285693353062954433549289258E0, [9] = 1.23605671757943030647266201528E1,
     [10] = 6.43392746015763530355970484046E-1},
    {[0] = 5.42937341165687622380535766363E-2, [5] = 4.45031289275240888144113950566E0,
     [6] = 1.89151789931450038304281599044E0, [7] = -5.8012039600105847814672114227E0,
     [8] = 3.1116436695781989440891606237E-1, [9] = -1.52160949662516078556178806805E-1,
     [10] = 2.01365400804030348374776537501E-1, [11] = 4.47106157277725905176885569043E-2},
};
static const double difference[STAGES] =
    {[0] = 0.1312004499419488073250102996E-01, [5] = -0.1225156446376204440720569753E+01,
     [6] = -0.4957589496572501915214079952E+00, [7] = 0.1664377182454986536961530415E+01,
     [8] = -0.3503288487499736816886487290E+00, [9] = 0.3341791187130174790297318841E+00,
     [10] = 0.8192320648511571246570742613E-01, [11] = -0.2235530786388629525884427845E-01};
static const double lower_order[STAGES] =
    {[0] = 5.42937341165687622380535766363E-2 - 0.244094488188976377952755905512,
     [5] = 4.45031289275240888144113950566E0, [6] = 1.89151789931450038304281599044E0,
     [7] = -5.8012039600105847814672114227E0,
     [8] = 3.1116436695781989440891606237E-1 - 0.733846688281611857341361741547,
     [9] = -1.52160949662516078556178806805E-1, [10] = 2.01365400804030348374776537501E-1,
     [11] = 4.47106157277725905176885569043E-2 - 0.220588235294117647058823529412E-01};
// clang-format on

const struct nystrom_pair dop853_pair = {.stages = STAGES,
                                         .power = 8,
                                         .nodes = nodes,
                                         .table = table,
                                         .difference = difference,
                                         .lower_order = lower_order};

struct dop853_options {
    double rtol, atol, dt_max;
    int64_t max_steps;
    int32_t order;
};

enum { ORDER_AUTOMATIC, ORDER_8 };
static const char *const orders[] = {"automatic", "8", NULL};

static const struct cs_option rows[] = {
    ADAPTIVE_ROWS(struct dop853_options, 1e-6),
    CS_OPTION_CHOICE(struct dop853_options, order, orders, ORDER_AUTOMATIC,
                     "automatic: 8, and 5 where contact, dt_max or frames limit steps"),
};

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct dop853_options *asked = options;
    const struct adaptive_options adaptive = {asked->rtol, asked->atol, asked->dt_max,
                                              asked->max_steps, false};
    return nystrom_create(host, &adaptive, &dop853_pair,
                          asked->order == ORDER_AUTOMATIC ? &dopri5_pair : NULL, out);
}

const struct cs_integrator dop853 = {
    NYSTROM_METHOD(struct dop853_options, rows),
    .name = "dop853",
    .summary = "explicit, order 8 with error control, 5 where contact or frames limit steps: "
               "for errors below 1e-7 of smooth motion",
    .source = "Prince, Dormand 1981; Hairer, Norsett, Wanner 1993, sec. II.10",
    .order = 8,
    .order_damped = 8,
    .traits = CS_ADAPTIVE,
    .create = create,
};
