/* Prints completion scripts for bash, zsh and fish from the tables of options. */
#include "cli/commands.h"

#include <string.h>

/* Source of completions for a value or an operand, derived from its placeholder in the help. */
enum source { NOTHING, METHODS, FOLDERS, FILES };

static enum source source_of(const char *value) {
    if (!strncmp(value, "NAME[:", 6) || !strncmp(value, "NAME:", 5) || !strcmp(value, "[NAME]"))
        return METHODS;
    if (!strncmp(value, "DIR", 3))
        return FOLDERS;
    return strstr(value, "FILE") || strstr(value, "SCENE") || strstr(value, "CSV") ? FILES
                                                                                   : NOTHING;
}

/* Adds text between single quotes; quotes and the characters of `special` are escaped. */
static void add_quoted(const char *text, const char *quote, const char *special,
                       struct cs_text *out) {
    for (; *text; text++)
        if (*text == '\'')
            cs_text_add(out, "%s", quote);
        else
            cs_text_add(out, "%s%c", strchr(special, *text) ? "\\" : "", *text);
}

/* the list of integrators without their descriptions */
static void add_methods(struct cs_text *out) {
    cs_text_add(out, "clothsim integrators 2>/dev/null | "
                     "sed -n 's/^\\([a-z0-9][a-z0-9-]*\\)  .*/\\1/p'");
}

/* " --name -n" of the options whose value has that source, or of all. */
static void add_names(const struct cs_command *command, bool all, enum source source,
                      struct cs_text *out) {
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows; row++)
        if (row->help && (all || (row->value && source_of(row->value) == source))) {
            cs_text_add(out, " --%s", row->name);
            if (row->short_name)
                cs_text_add(out, " -%c", row->short_name);
        }
}

static void add_bash(const struct cs_command *const *commands, struct cs_text *out) {
    cs_text_add(out,
                "# bash completion for clothsim\n"
                "_clothsim() {\n"
                "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
                "    local commands='help");
    for (uint32_t i = 0; commands[i]; i++)
        cs_text_add(out, " %s", commands[i]->name);
    cs_text_add(out, "' options= methods= folders= operands=\n"
                     "    case $COMP_CWORD:${COMP_WORDS[1]} in\n"
                     "    1:*) options='--help --version -h -V' operands=$commands ;;\n"
                     "    2:help) operands=$commands ;;\n");
    for (uint32_t i = 0; commands[i]; i++) {
        cs_text_add(out, "    *:%s)\n        options='--help -h", commands[i]->name);
        add_names(commands[i], true, NOTHING, out);
        cs_text_add(out, "'\n        methods='");
        add_names(commands[i], false, METHODS, out);
        cs_text_add(out, " '\n        folders='");
        add_names(commands[i], false, FOLDERS, out);
        cs_text_add(out, " '\n");
        if (source_of(commands[i]->operands) == METHODS)
            cs_text_add(out, "        methods+=\"$before \"\n");
        cs_text_add(out, "        ;;\n");
    }
    /* an empty reply leaves the word to the completion of file names */
    cs_text_add(out, "    esac\n"
                     "    if [[ $word == -* ]]; then operands=$options\n"
                     "    elif [[ $methods == *\" $before \"* ]]; then operands=$(");
    add_methods(out);
    cs_text_add(out, ")\n"
                     "    elif [[ $folders == *\" $before \"* ]]; then\n"
                     "        mapfile -t COMPREPLY < <(compgen -d -- \"$word\")\n"
                     "        return\n"
                     "    fi\n"
                     "    mapfile -t COMPREPLY < <(compgen -W \"$operands\" -- \"$word\")\n"
                     "}\n"
                     "complete -o default -F _clothsim clothsim\n");
}

static const char *zsh_action(enum source source) {
    return source == METHODS   ? "_clothsim_methods"
           : source == FOLDERS ? "_files -/"
           : source == FILES   ? "_files"
                               : " ";
}

/* one argument of _arguments; attached is what lets the value follow without a blank */
static void add_zsh_option(const struct cs_arg *row, const char *dashes, const char *name,
                           const char *attached, struct cs_text *out) {
    cs_text_add(out, " \\\n            '%s%s%s%s[", row->repeatable ? "*" : "", dashes, name,
                row->value ? attached : "");
    add_quoted(row->help, "'\\''", "[]:\\", out);
    cs_text_add(out, "]");
    if (row->value) {
        cs_text_add(out, ":");
        add_quoted(row->value, "'\\''", "[]:\\", out);
        cs_text_add(out, ":%s", zsh_action(source_of(row->value)));
    }
    cs_text_add(out, "'");
}

static void add_zsh_command(const struct cs_command *command, struct cs_text *out) {
    cs_text_add(out, "    %s)\n        _arguments '(-h --help)'{-h,--help}'[this text]'",
                command->name);
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows;
         row++) {
        if (!row->help)
            continue;
        add_zsh_option(row, "--", row->name, "=", out);
        if (row->short_name)
            add_zsh_option(row, "-", (const char[]){row->short_name, 0}, "+", out);
    }
    if (*command->operands) {
        cs_text_add(out, " \\\n            '*:");
        add_quoted(command->operands, "'\\''", "[]:\\", out);
        cs_text_add(out, ":%s'", zsh_action(source_of(command->operands)));
    }
    cs_text_add(out, " ;;\n");
}

static void add_zsh(const struct cs_command *const *commands, struct cs_text *out) {
    cs_text_add(out, "#compdef clothsim\n"
                     "_clothsim_methods() {\n"
                     "    local -a methods=(${(f)\"$(");
    add_methods(out);
    cs_text_add(out, ")\"})\n"
                     "    compadd -a methods || _files\n"
                     "}\n"
                     "_clothsim() {\n"
                     "    local -a commands=('help:this text, or the options of a command'");
    for (uint32_t i = 0; commands[i]; i++) {
        cs_text_add(out, " \\\n        '%s:", commands[i]->name);
        add_quoted(commands[i]->summary, "'\\''", ":\\", out);
        cs_text_add(out, "'");
    }
    cs_text_add(out, ")\n"
                     "    if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then\n"
                     "        _describe command commands\n"
                     "        return\n"
                     "    fi\n"
                     "    shift words\n"
                     "    (( CURRENT-- ))\n"
                     "    case $words[1] in\n");
    for (uint32_t i = 0; commands[i]; i++)
        add_zsh_command(commands[i], out);
    cs_text_add(out, "    esac\n"
                     "}\n"
                     "_clothsim \"$@\"\n");
}

static const char *fish_action(enum source source) {
    return source == METHODS   ? " -x -a '(__clothsim_methods)'"
           : source == FOLDERS ? " -x -a '(__fish_complete_directories)'"
           : source == FILES   ? " -r -F"
                               : " -x";
}

static void add_fish_command(const struct cs_command *command, struct cs_text *out) {
    static const char seen[] = "complete -c clothsim -n '__fish_seen_subcommand_from ";
    cs_text_add(out, "complete -c clothsim -n __fish_use_subcommand -a %s -d '", command->name);
    add_quoted(command->summary, "\\'", "\\", out);
    cs_text_add(out, "'\n%s%s' -s h -l help -d 'this text'\n", seen, command->name);
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows;
         row++) {
        if (!row->help)
            continue;
        cs_text_add(out, "%s%s'", seen, command->name);
        if (row->short_name)
            cs_text_add(out, " -s %c", row->short_name);
        cs_text_add(out, " -l %s%s -d '", row->name,
                    row->value ? fish_action(source_of(row->value)) : "");
        add_quoted(row->help, "\\'", "\\", out);
        cs_text_add(out, "'\n");
    }
    const enum source source = source_of(command->operands);
    if (source != NOTHING)
        cs_text_add(out, "%s%s'%s\n", seen, command->name,
                    source == FILES ? " -F" : " -F -a '(__clothsim_methods)'");
}

static void add_fish(const struct cs_command *const *commands, struct cs_text *out) {
    cs_text_add(out, "# fish completion for clothsim\n"
                     "function __clothsim_methods\n"
                     "    ");
    add_methods(out);
    cs_text_add(out,
                "\nend\n"
                "complete -c clothsim -f\n"
                "complete -c clothsim -n __fish_use_subcommand -s h -l help -d 'this text'\n"
                "complete -c clothsim -n __fish_use_subcommand -s V -l version\n"
                "complete -c clothsim -n __fish_use_subcommand -a help\n");
    for (uint32_t i = 0; commands[i]; i++)
        add_fish_command(commands[i], out);
}

enum cs_status cs_completion_print(const struct cs_command *const *commands, const char *shell,
                                   struct cs_text *out, struct cs_error *error) {
    if (!strcmp(shell, "bash"))
        add_bash(commands, out);
    else if (!strcmp(shell, "zsh"))
        add_zsh(commands, out);
    else if (!strcmp(shell, "fish"))
        add_fish(commands, out);
    else
        return cs_fail(error, CS_ERR_USAGE,
                       "no completion for \"%.60s\", expected bash, zsh or fish", shell);
    return CS_OK;
}
