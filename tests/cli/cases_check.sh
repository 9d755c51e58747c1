#!/bin/sh
# cases_check.sh PROGRAM - the runner of cases itself: what it passes, and that of a case that fails
# it tells the command and the lines that differ, and nothing else.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

cat >"$work/some.case" <<'CASE'
# the same, with and without wildcards
$ printf 'one\ntwo 2 words\nthree\nfour\n'
one
two ... words
...
$ printf 'a\nb\nc\n'
...
b
...
$ exit 3
! 3

# a line that differs among others
$ echo fine
fine
$ printf '1\n2\nthree\n4\n5\n'
1
2
3
4
5

# a line too few, one too many, and wildcards that stand for what was found
$ printf 'head\nx\ny\nmiddle 7\ntail\nmore\n'
head
...
middle ...
lost
tail

# the code alone
$ echo out; exit 4
! 5
out
CASE
code=0
"$here/cases.sh" "$1" "$work/some.case" >"$work/found" 2>&1 || code=$?
cat >"$work/expected" <<'TAP'
ok 1 - some: the same, with and without wildcards
not ok 2 - some: a line that differs among others
#   $ printf '1\n2\nthree\n4\n5\n'
#   - 3
#   + three
not ok 3 - some: a line too few, one too many, and wildcards that stand for what was found
#   $ printf 'head\nx\ny\nmiddle 7\ntail\nmore\n'
#   - lost
#   + more
not ok 4 - some: the code alone
#   $ echo out; exit 4
#   exit code 4, expected 5
1..4
TAP
diff "$work/expected" "$work/found"
[ $code = 1 ]
