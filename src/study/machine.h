/* machine.h - what a measurement was taken on. */
#ifndef CS_MACHINE_H
#define CS_MACHINE_H

struct cs_machine {
    char host[64], processor[128]; /* "" unknown */
    long processors;
    double load; /* of the last minute */
    const char *version, *compiler, *flags;
};

void cs_machine_detect(struct cs_machine *machine);

enum { CS_MACHINE_NAME = 200 };
/* "host: processor": times that bear the same name can be held against each other. */
void cs_machine_name(char name[CS_MACHINE_NAME]);

#endif
