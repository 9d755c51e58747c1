/* Describes the processor, compiler and load under which a measurement was taken. */
#include "study/machine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

/* Reads the model name from /proc/cpuinfo; unchanged if there is none. */
static void read_processor(char *name, size_t size) {
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "re");
    while (file && fgets(line, sizeof line, file))
        if (!strncmp(line, "model name", 10) && strchr(line, ':')) {
            snprintf(name, size, "%s", strchr(line, ':') + 2);
            name[strcspn(name, "\n")] = 0;
            break;
        }
    if (file)
        fclose(file);
}

/* Compiler and flags are those of this file's build, which are the same for the whole program.
 */
void cs_machine_detect(struct cs_machine *machine) {
    *machine = (struct cs_machine){.version = CS_VERSION,
#ifdef __clang__
                                   .compiler = "clang " __clang_version__,
#else
                                   .compiler = "gcc " __VERSION__,
#endif
#ifdef __OPTIMIZE__
                                   .flags = "optimised, -ffp-contract=off",
#else
                                   .flags = "NOT optimised, -ffp-contract=off",
#endif
                                   .processors = sysconf(_SC_NPROCESSORS_ONLN)};
    struct utsname system;
    if (!uname(&system))
        snprintf(machine->host, sizeof machine->host, "%.63s", system.nodename);
    read_processor(machine->processor, sizeof machine->processor);
    if (getloadavg(&machine->load, 1) != 1)
        machine->load = 0;
}

void cs_machine_name(char name[CS_MACHINE_NAME]) {
    struct cs_machine machine;
    cs_machine_detect(&machine);
    snprintf(name, CS_MACHINE_NAME, "%s: %s", machine.host, machine.processor);
}
