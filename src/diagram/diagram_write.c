/* Loads the module that draws diagrams, and calls it; part of the program, and free of cairo.
 */
#include "diagram/diagram.h"

#include "base/file.h"
#include "base/install_paths.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* s of wall time after which a drawing that hangs is ended; it takes a fraction of one */
enum { DRAW_SECONDS = 60 };

/* In a process of its own: the libraries below cairo do not survive a lack of memory. */
static void draw_and_exit(const struct cs_diagram_module *module,
                          const struct cs_diagram *diagram, enum cs_format format, int end) {
    static const int crashes[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL};
    struct cs_error error = {0};
    char *bytes;
    size_t length;
    for (size_t k = 0; k < sizeof crashes / sizeof *crashes; k++)
        signal(crashes[k], SIG_DFL);
    alarm(DRAW_SECONDS);
    if (!module->draw(diagram, format, &bytes, &length, &error))
        for (ssize_t n; length && (n = write(end, bytes, length)) > 0; length -= (size_t)n)
            bytes += n;
    _exit(error.status || length ? 1 : 0);
}

static enum cs_status draw(const char *folder, const struct cs_diagram *diagram,
                           enum cs_format format, char **bytes, size_t *length,
                           struct cs_error *error) {
    const struct cs_diagram_module *module = cs_table_open(
        folder, "diagram-cairo", "clothsim_diagram", CS_DIAGRAM_ABI, "libcairo2-dev", error);
    struct cs_text out = {0};
    char part[4096];
    int ends[2], status = -1;
    *bytes = NULL;
    if (!module)
        return error->status;
    if (pipe2(ends, O_CLOEXEC))
        return cs_fail(error, CS_ERR_FILE, "cannot make a pipe: %s", strerror(errno));
    const pid_t child = fork();
    if (child == 0)
        draw_and_exit(module, diagram, format, ends[1]);
    close(ends[1]);
    for (ssize_t n; child > 0 &&
                    ((n = read(ends[0], part, sizeof part)) > 0 || (n < 0 && errno == EINTR));)
        if (n > 0)
            cs_text_add_bytes(&out, part, (size_t)n);
    close(ends[0]);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    *bytes = out.bytes;
    *length = out.length;
    if (!status && !out.failed && out.length)
        return CS_OK;
    cs_text_finish(&out);
    return cs_fail(error, CS_ERR_MODULE,
                   "the module diagram-cairo.so ended without a diagram: out of memory?");
}

enum cs_status cs_diagram_write(const char *folder, const struct cs_diagram *diagram,
                                const char *path, unsigned formats, struct cs_error *error) {
    for (int format = 0; format < CS_FORMATS && !error->status; format++) {
        char name[4200], *bytes;
        size_t length;
        if (!(formats >> format & 1) ||
            draw(folder, diagram, (enum cs_format)format, &bytes, &length, error))
            continue;
        snprintf(name, sizeof name, "%s.%s", path, cs_format_names[format]);
        cs_file_write(name, bytes, length, error);
        free(bytes);
    }
    return error->status;
}

enum cs_status cs_diagram_add_svg(const char *folder, const struct cs_diagram *diagram,
                                  struct cs_text *out, struct cs_error *error) {
    char *bytes;
    size_t length;
    if (!draw(folder, diagram, CS_FORMAT_SVG, &bytes, &length, error)) {
        const char *element = strstr(bytes, "<svg"); /* without the head of an XML file */
        cs_text_add(out, "%s", element ? element : "");
        free(bytes);
    }
    return error->status;
}
