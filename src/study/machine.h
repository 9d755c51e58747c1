/* machine.h - describes the machine that a measurement was made on. */
#ifndef CS_MACHINE_H
#define CS_MACHINE_H

/* Facts of the machine and the build; texts without a size are constants. */
struct cs_machine {
    char host[64], processor[128]; /* "" unknown */
    long processors;
    double load; /* of the last minute */
    const char *version, *compiler, *flags;
};

/* Fills in what can be found out; unknown facts are "" or 0. Does not fail. */
void cs_machine_detect(struct cs_machine *machine);

enum { CS_MACHINE_NAME = 200 };
/* Writes "host: processor". Times under equal names are comparable. */
void cs_machine_name(char name[CS_MACHINE_NAME]);

#endif
