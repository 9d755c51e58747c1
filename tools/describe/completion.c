/* Prints completion scripts for bash, zsh and fish. Values that the program knows are asked of
 * it: clothsim --complete. */
#include "describe/completion.h"

#include "describe/completion_values.h"

#include <string.h>

/* Adds text between single quotes; quotes and the characters of `special` are escaped. */
static void add_quoted(const char *text, const char *quote, const char *special,
                       struct cs_text *out) {
    for (; *text; text++)
        if (*text == '\'')
            cs_text_add(out, "%s", quote);
        else
            cs_text_add(out, "%s%c", strchr(special, *text) ? "\\" : "", *text);
}

/* " --name -n" of the options with that source of values, or of all. */
static void add_names(const struct cs_command *command, bool all,
                      enum cs_completion_source source, struct cs_text *out) {
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows; row++)
        if (row->help && (all || cs_completion_source_of_row(row) == source)) {
            cs_text_add(out, " --%s", row->name);
            if (row->short_name)
                cs_text_add(out, " -%c", row->short_name);
        }
}

static void add_bash_command(const struct cs_command *command, struct cs_text *out) {
    cs_text_add(out, "    *:%s)\n        options='--help -h", command->name);
    add_names(command, true, CS_COMPLETE_NOTHING, out);
    cs_text_add(out, "'\n        folders='");
    add_names(command, false, CS_COMPLETE_FOLDERS, out);
    cs_text_add(out, " ' ;;\n");
}

static void add_bash(const struct cs_command *const *commands, const char *parts,
                     struct cs_text *out) {
    /* bash splits words at : and =, and replaces only what stands behind the last of them */
    cs_text_add(out,
                "# bash completion for clothsim\n"
                "_clothsim() {\n"
                "    local line=${COMP_LINE:0:COMP_POINT} breaks=${COMP_WORDBREAKS//[^:=]/}\n"
                "    local -a words\n"
                "    read -ra words <<<\"$line\"\n"
                "    [[ $line != *[[:space:]] ]] || words+=('')\n"
                "    local word=${words[-1]} before=${words[-2]} cut=\n"
                "    [[ $word != --*=* ]] || { before=${word%%%%=*}; word=${word#*=}; }\n"
                "    local commands='help");
    for (uint32_t i = 0; commands[i]; i++)
        cs_text_add(out, " %s", commands[i]->name);
    cs_text_add(out, "' options= folders= operands=\n"
                     "    case ${#words[@]}:${words[1]} in\n"
                     "    2:*) options='--help --version -h -V' operands=$commands ;;\n"
                     "    3:help) operands=$commands ;;\n");
    /* an empty reply leaves the word to the completion of file names */
    cs_text_add(
        out,
        "%s    esac\n"
        "    [[ -z $breaks ]] || cut=${word%%\"${word##*[$breaks]}\"}\n"
        "    if [[ $word == -* ]]; then operands=$options\n"
        "    elif [[ $folders == *\" $before \"* ]]; then\n"
        "        mapfile -t COMPREPLY < <(compgen -d -- \"$word\")\n"
        "        return\n"
        "    elif [[ -z $operands ]]; then\n"
        "        mapfile -t COMPREPLY < <(\"${words[0]}\" --complete \"${words[1]}\" "
        "\"$before\" \"$word\" 2>/dev/null)\n"
        "        COMPREPLY=(\"${COMPREPLY[@]#\"$cut\"}\")\n"
        "        COMPREPLY=(\"${COMPREPLY[@]// /\\\\ }\")\n"
        "        [[ ${#COMPREPLY[@]} -ne 1 || $COMPREPLY != *[.=] ]] || compopt -o nospace\n"
        "        return\n"
        "    fi\n"
        "    mapfile -t COMPREPLY < <(compgen -W \"$operands\" -- \"$word\")\n"
        "}\n"
        "complete -o default -F _clothsim clothsim\n",
        parts);
}

/* option: long name, "" of operands. The blank before a call keeps zsh from adding to it. */
static void add_zsh_action(const struct cs_command *command, const char *option,
                           enum cs_completion_source source, struct cs_text *out) {
    if (source >= CS_COMPLETE_METHOD)
        cs_text_add(out, " _clothsim_values %s --%s", command->name, option);
    else
        cs_text_add(out, "%s",
                    source == CS_COMPLETE_FOLDERS ? "_files -/"
                    : source == CS_COMPLETE_FILES ? "_files"
                                                  : " ");
}

/* one argument of _arguments; attached is what lets the value follow without a blank */
static void add_zsh_option(const struct cs_command *command, const struct cs_arg *row,
                           const char *dashes, const char *name, const char *attached,
                           struct cs_text *out) {
    cs_text_add(out, " \\\n            '%s%s%s%s[", row->repeatable ? "*" : "", dashes, name,
                row->value ? attached : "");
    add_quoted(row->help, "'\\''", "[]:\\", out);
    cs_text_add(out, "]");
    if (row->value) {
        cs_text_add(out, ":");
        add_quoted(row->value, "'\\''", "[]:\\", out);
        cs_text_add(out, ":");
        add_zsh_action(command, row->name, cs_completion_source_of_row(row), out);
    }
    cs_text_add(out, "'");
}

/* one branch per command, whose first word is then the command itself */
static void add_zsh_command(const struct cs_command *command, struct cs_text *out) {
    cs_text_add(out, "    %s)\n        _arguments '(-h --help)'{-h,--help}'[this text]'",
                command->name);
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows;
         row++) {
        /* rows without help are not offered */
        if (!row->help)
            continue;
        add_zsh_option(command, row, "--", row->name, "=", out);
        if (row->short_name)
            add_zsh_option(command, row, "-", (const char[]){row->short_name, 0}, "+", out);
    }
    if (*command->operands) {
        cs_text_add(out, " \\\n            '*:");
        add_quoted(command->operands, "'\\''", "[]:\\", out);
        cs_text_add(out, ":");
        add_zsh_action(command, "", cs_completion_source_of(command->operands), out);
        cs_text_add(out, "'");
    }
    cs_text_add(out, " ;;\n");
}

static void add_zsh(const struct cs_command *const *commands, const char *parts,
                    struct cs_text *out) {
    cs_text_add(out, "#compdef clothsim\n"
                     "_clothsim_values() {\n"
                     "    local -a values=(${(f)\"$(clothsim --complete $1 $2 \"${(Q)PREFIX}\" "
                     "2>/dev/null)\"})\n"
                     "    [[ -n $values ]] && compadd -S '' -a values || _files\n"
                     "}\n"
                     "_clothsim() {\n"
                     "    local -a commands=('help:this text, or the options of a command'");
    for (uint32_t i = 0; commands[i]; i++) {
        cs_text_add(out, " \\\n        '%s:", commands[i]->name);
        add_quoted(commands[i]->summary, "'\\''", ":\\", out);
        cs_text_add(out, "'");
    }
    cs_text_add(out,
                ")\n"
                "    if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then\n"
                "        _describe command commands\n"
                "        return\n"
                "    fi\n"
                "    shift words\n"
                "    (( CURRENT-- ))\n"
                "    case $words[1] in\n"
                "%s    esac\n"
                "}\n"
                "_clothsim \"$@\"\n",
                parts);
}

/* Within double quotes; "--name=" before a value stays behind. */
static void add_fish_action(const struct cs_command *command, const char *option,
                            enum cs_completion_source source, struct cs_text *out) {
    if (source >= CS_COMPLETE_METHOD)
        cs_text_add(out, " -x -a '(__clothsim_values %s --%s)'", command->name, option);
    else
        cs_text_add(out, "%s",
                    source == CS_COMPLETE_FOLDERS ? " -x -a '(__fish_complete_directories)'"
                    : source == CS_COMPLETE_FILES ? " -r -F"
                                                  : " -x");
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
        cs_text_add(out, " -l %s", row->name);
        if (row->value)
            add_fish_action(command, row->name, cs_completion_source_of_row(row), out);
        cs_text_add(out, " -d '");
        add_quoted(row->help, "\\'", "\\", out);
        cs_text_add(out, "'\n");
    }
    /* -F allows the files that -f at the top forbids */
    const enum cs_completion_source source = cs_completion_source_of(command->operands);
    if (source == CS_COMPLETE_FILES)
        cs_text_add(out, "%s%s' -F\n", seen, command->name);
    else if (source >= CS_COMPLETE_METHOD)
        cs_text_add(out, "%s%s' -F -a '(__clothsim_values %s --)'\n", seen, command->name,
                    command->name);
}

static void add_fish(const struct cs_command *const *commands, const char *parts,
                     struct cs_text *out) {
    (void)commands; // named by their parts
    cs_text_add(out,
                "# fish completion for clothsim\n"
                "function __clothsim_values\n"
                "    set -l word (commandline -ct)\n"
                "    set word (string replace -r -- '^--[a-z-]+=' '' \"$word\")\n"
                "    clothsim --complete $argv \"$word\" 2>/dev/null\n"
                "end\n"
                "complete -c clothsim -f\n"
                "complete -c clothsim -n __fish_use_subcommand -s h -l help -d 'this text'\n"
                "complete -c clothsim -n __fish_use_subcommand -s V -l version\n"
                "complete -c clothsim -n __fish_use_subcommand -a help\n%s",
                parts);
}

static const struct {
    const char *name;
    void (*add_command)(const struct cs_command *command, struct cs_text *out);
    void (*add)(const struct cs_command *const *commands, const char *parts,
                struct cs_text *out);
} shells[] = {{"bash", add_bash_command, add_bash},
              {"zsh", add_zsh_command, add_zsh},
              {"fish", add_fish_command, add_fish}};
enum { SHELLS = sizeof shells / sizeof *shells };

enum cs_status cs_completion_print(const struct cs_command *const *commands, const char *shell,
                                   struct cs_text *out, struct cs_error *error) {
    struct cs_text parts = {0};
    size_t k = 0;
    while (k < SHELLS && strcmp(shells[k].name, shell) != 0)
        k++;
    if (k == SHELLS)
        return cs_fail(error, CS_ERR_USAGE,
                       "no completion for \"%.60s\", expected bash, zsh or fish", shell);
    for (uint32_t i = 0; commands[i]; i++)
        shells[k].add_command(commands[i], &parts);
    shells[k].add(commands, cs_text_get(&parts), out);
    out->failed |= parts.failed;
    cs_text_finish(&parts);
    return CS_OK;
}
