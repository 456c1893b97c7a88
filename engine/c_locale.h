/* Numbers are read and written with a decimal point, whatever locale the host program has set: switch this thread to
 * the C locale and back. */
#ifndef SCREE_ENGINE_C_LOCALE_H
#define SCREE_ENGINE_C_LOCALE_H

#include <locale.h>

struct scree_c_locale {
    locale_t c, before;
};

static inline struct scree_c_locale scree_enter_c_locale(void) {
    struct scree_c_locale switched = {newlocale(LC_ALL_MASK, "C", (locale_t)0), (locale_t)0};
    if (switched.c) switched.before = uselocale(switched.c);
    return switched;
}

static inline void scree_leave_c_locale(struct scree_c_locale switched) {
    if (!switched.c) return;
    uselocale(switched.before);
    freelocale(switched.c);
}

#endif
