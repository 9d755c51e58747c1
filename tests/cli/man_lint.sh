#!/bin/sh
# man_lint.sh PAGE ... - no page has anything that mandoc warns of
set -eu
command -v mandoc >/dev/null || exit 77
found=$(mandoc -T lint -W warning "$@" 2>&1 || true)
[ -z "$found" ] || {
    echo "$found"
    exit 1
}
