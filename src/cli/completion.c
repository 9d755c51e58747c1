/* Prints completion scripts for bash, zsh and fish, and the values they offer. */
#include "base/options.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "io/export/export.h"
#include "scene/scene.h"
#include "sim/registry.h"
#include "study/compare/compare_cell.h"
#include "study/conform/conform.h"

#include <stdio.h>
#include <string.h>

/* Source of completions for a value or an operand, derived from its placeholder in the help;
 * from METHOD on `clothsim --complete` knows them. */
enum source { NOTHING, FOLDERS, FILES, METHOD, METHODS, PATHS, WORDS };

/* Words of placeholders; with a comma in it a list of them. */
static const char *const *words_of(const struct cs_arg *row) {
    const char *value = row->value;
    return row->names                       ? row->names
           : !strcmp(value, "COLUMN")       ? cs_column_axes()
           : !strcmp(value, "FAMILY")       ? cs_family_names
           : !strcmp(value, "FORMAT[,...]") ? cs_export_format_names
           : !strcmp(value, "VALUE[,...]")  ? cs_export_value_names
           : !strcmp(value, "CHECK[,...]")  ? cs_conform_check_names()
                                            : NULL;
}

static enum source source_of(const char *value) {
    if (!strcmp(value, "LIST"))
        return METHODS;
    if (!strncmp(value, "NAME[:", 6) || !strncmp(value, "NAME:", 5) || !strcmp(value, "[NAME]"))
        return METHOD;
    if (!strncmp(value, "PATH=", 5))
        return PATHS;
    if (!strncmp(value, "DIR", 3))
        return FOLDERS;
    return strstr(value, "FILE") || strstr(value, "SCENE") || strstr(value, "CSV") ? FILES
                                                                                   : NOTHING;
}

static enum source source_of_row(const struct cs_arg *row) {
    return !row->value ? NOTHING : words_of(row) ? WORDS : source_of(row->value);
}

/* The word that is completed, and the words that it may become. */
struct word {
    const char *text; /* as it is typed so far */
    size_t start;     /* of the item in it that is completed */
    struct cs_text *out;
};

static void offer(const struct word *word, const char *item, const char *end) {
    const char *typed = word->text + word->start;
    if (!strncmp(item, typed, strlen(typed)))
        cs_text_add(word->out, "%.*s%s%s\n", (int)word->start, word->text, item, end);
}

static void offer_all(const struct word *word, const char *const *items) {
    for (; items && *items; items++)
        offer(word, *items, "");
}

/* Start of the item behind the last separator. */
static size_t item_start(const char *text, const char *separators) {
    size_t start = strlen(text);
    while (start > 0 && !strchr(separators, text[start - 1]))
        start--;
    return start;
}

/* The row of a key of that length, or NULL. */
static const struct cs_option *find_key(const struct cs_table *table, const char *key,
                                        size_t length) {
    for (const struct cs_option *row = table->rows; row < table->rows + table->n; row++)
        if (strlen(row->name) == length && !strncmp(row->name, key, length))
            return row;
    return NULL;
}

/* Keys of a table, or behind "key=" the names that the key takes. */
static void offer_keys(struct word *word, const struct cs_table *table) {
    static const char *const switches[] = {"true", "false", NULL};
    const size_t length = strcspn(word->text + word->start, "=");
    const bool valued = word->text[word->start + length] == '=';
    const struct cs_option *row =
        valued ? find_key(table, word->text + word->start, length) : NULL;
    if (row) {
        word->start += length + 1;
        offer_all(word, row->type == CS_BOOL ? switches : row->choices);
    }
    for (row = table->rows; !valued && row < table->rows + table->n; row++)
        offer(word, row->name, !row->table ? "=" : row->type == CS_LIST ? "[0]." : ".");
}

/* NAME:key=value,key=value, and in a list, behind a comma, the next NAME. */
static void complete_methods(struct word *word, bool list) {
    struct cs_registry registry = {0};
    struct cs_error ignored = {0};
    const struct cs_registry_entry *entry;
    const char *text = word->text, *colon = strrchr(text, ':');
    uint32_t n;
    word->start = item_start(text, ",:");
    if (word->start ? list && text[word->start - 1] == ',' : true)
        offer_all(word, cs_registry_names(&registry, true, &n, &ignored));
    /* behind a colon the options of the method before it, up to the next method */
    if (colon) {
        char name[64];
        const char *first = colon;
        while (first > text && first[-1] != ',')
            first--;
        snprintf(name, sizeof name, "%.*s", (int)(colon - first), first);
        if (!cs_registry_find(&registry, name, &entry, &ignored))
            offer_keys(word, &(struct cs_table){.rows = entry->integrator->options,
                                                .n = entry->integrator->n_options});
    }
    cs_registry_finish(&registry);
}

/* One step of a path at a time: bodies[0]. springs. stretch= */
static void complete_path(struct word *word) {
    static const char method[] = "integrator.name=";
    const struct cs_table *table = &cs_scene_table;
    if (!strncmp(word->text, method, sizeof method - 1)) {
        struct word name = {word->text + sizeof method - 1, 0, &(struct cs_text){0}};
        complete_methods(&name, false);
        cs_print_lines(method, cs_text_get(name.out), word->out);
        cs_text_finish(name.out);
        return;
    }
    const size_t end = strcspn(word->text, "=");
    for (size_t dot; (dot = word->start + strcspn(word->text + word->start, ".")) < end;) {
        const char *key = word->text + word->start;
        const struct cs_option *row = find_key(table, key, strcspn(key, ".["));
        if (!row || !row->table)
            return;
        table = row->table;
        word->start = dot + 1;
    }
    /* the keys of an integrator are in no table; these two all scenes may have */
    if (!word->start) {
        offer(word, "integrator.name", "=");
        offer(word, "integrator.dt", "=");
    }
    offer_keys(word, table);
}

/* True for the long name, its singular (--integrator for --integrators) and its old name. */
static bool is_name(const struct cs_arg *row, const char *name) {
    const size_t n = strlen(name);
    return (row->old_name && !strcmp(row->old_name, name)) ||
           (!strncmp(row->name, name, n) && (!row->name[n] || !strcmp(row->name + n, "s")));
}

/* The row of "--name" or "-n" that takes a value, or NULL. */
static const struct cs_arg *find_row(const struct cs_command *command, const char *option) {
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows; row++)
        if (row->value && *option == '-' &&
            (option[1] == '-' ? is_name(row, option + 2)
                              : row->short_name && option[1] == row->short_name && !option[2]))
            return row;
    return NULL;
}

void cs_completion_print_values(const struct cs_command *command, const char *option,
                                const char *text, struct cs_text *out) {
    const struct cs_arg *row = find_row(command, option);
    const enum source source = row ? source_of_row(row) : source_of(command->operands);
    struct word word = {.text = text, .out = out};
    if (source == METHOD || source == METHODS)
        complete_methods(&word, source == METHODS);
    else if (source == PATHS)
        complete_path(&word);
    else if (source == WORDS) {
        word.start = strchr(row->value, ',') ? item_start(text, ",") : 0;
        offer_all(&word, words_of(row));
    }
}

/* Scripts. Values that the program knows are asked of it: clothsim --complete. */

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
static void add_names(const struct cs_command *command, bool all, enum source source,
                      struct cs_text *out) {
    for (const struct cs_arg *row = command->rows; row < command->rows + command->n_rows; row++)
        if (row->help && (all || source_of_row(row) == source)) {
            cs_text_add(out, " --%s", row->name);
            if (row->short_name)
                cs_text_add(out, " -%c", row->short_name);
        }
}

static void add_bash(const struct cs_command *const *commands, struct cs_text *out) {
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
    for (uint32_t i = 0; commands[i]; i++) {
        cs_text_add(out, "    *:%s)\n        options='--help -h", commands[i]->name);
        add_names(commands[i], true, NOTHING, out);
        cs_text_add(out, "'\n        folders='");
        add_names(commands[i], false, FOLDERS, out);
        cs_text_add(out, " ' ;;\n");
    }
    /* an empty reply leaves the word to the completion of file names */
    cs_text_add(
        out,
        "    esac\n"
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
        "complete -o default -F _clothsim clothsim\n");
}

/* option: long name, "" of operands. The blank before a call keeps zsh from adding to it. */
static void add_zsh_action(const struct cs_command *command, const char *option,
                           enum source source, struct cs_text *out) {
    if (source >= METHOD)
        cs_text_add(out, " _clothsim_values %s --%s", command->name, option);
    else
        cs_text_add(out, "%s",
                    source == FOLDERS ? "_files -/"
                    : source == FILES ? "_files"
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
        add_zsh_action(command, row->name, source_of_row(row), out);
    }
    cs_text_add(out, "'");
}

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
        add_zsh_action(command, "", source_of(command->operands), out);
        cs_text_add(out, "'");
    }
    cs_text_add(out, " ;;\n");
}

static void add_zsh(const struct cs_command *const *commands, struct cs_text *out) {
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
    cs_text_add(out, ")\n"
                     "    if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then\n"
                     "        _describe command commands\n"
                     "        return\n"
                     "    fi\n"
                     "    shift words\n"
                     "    (( CURRENT-- ))\n"
                     "    case $words[1] in\n");
    /* one branch per command, whose first word is then the command itself */
    for (uint32_t i = 0; commands[i]; i++)
        add_zsh_command(commands[i], out);
    cs_text_add(out, "    esac\n"
                     "}\n"
                     "_clothsim \"$@\"\n");
}

/* Within double quotes; "--name=" before a value stays behind. */
static void add_fish_action(const struct cs_command *command, const char *option,
                            enum source source, struct cs_text *out) {
    if (source >= METHOD)
        cs_text_add(out, " -x -a '(__clothsim_values %s --%s)'", command->name, option);
    else
        cs_text_add(out, "%s",
                    source == FOLDERS ? " -x -a '(__fish_complete_directories)'"
                    : source == FILES ? " -r -F"
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
            add_fish_action(command, row->name, source_of_row(row), out);
        cs_text_add(out, " -d '");
        add_quoted(row->help, "\\'", "\\", out);
        cs_text_add(out, "'\n");
    }
    /* -F allows the files that -f at the top forbids */
    const enum source source = source_of(command->operands);
    if (source == FILES)
        cs_text_add(out, "%s%s' -F\n", seen, command->name);
    else if (source >= METHOD)
        cs_text_add(out, "%s%s' -F -a '(__clothsim_values %s --)'\n", seen, command->name,
                    command->name);
}

static void add_fish(const struct cs_command *const *commands, struct cs_text *out) {
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
