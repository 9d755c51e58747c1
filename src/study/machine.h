/* machine.h - what a measurement was taken on. */
#ifndef CS_MACHINE_H
#define CS_MACHINE_H

struct cs_machine {
    char processor[128]; /* "" unknown */
    long processors;
    double load; /* of the last minute */
    const char *version, *compiler, *flags;
};

void cs_machine_look(struct cs_machine *machine);

#endif
