# split.awk - the cases of a file as folders: work/0001/ with title, folder/ and, for each command,
# 01.command, 01.code and 01.expected
function begin() {
    if (dir)
        return
    dir = sprintf("%s/%04d", work, ++cases)
    system("mkdir -p '" dir "/folder'")
    step = 0
    printf "" > (dir "/title")
}
function end() {
    if (dir && !step)
        print "no command in a case before line " NR > "/dev/stderr"
    dir = ""
}
function base() { return sprintf("%s/%02d", dir, step) }
function flush_files() { close(base() ".expected"); close(base() ".code") }

into != "" {
    if ($0 == "<<") { close(into); into = "" } else print > into
    next
}
/^$/ { if (step) flush_files(); end(); next }
{ begin() }
/^# / { printf "%s%s", (titled[dir]++ ? " " : ""), substr($0, 3) > (dir "/title"); next }
/^<< / { into = dir "/folder/" $2; printf "" > into; next }
/^< / {
    name = dir "/folder/" $2
    text = substr($0, 3)
    sub(/^[^ ]* /, "", text)
    print text > name
    close(name)
    next
}
/^\$ / {
    if (step) flush_files()
    step++
    print substr($0, 3) > (base() ".command")
    close(base() ".command")
    print 0 > (base() ".code")
    close(base() ".code")
    printf "" > (base() ".expected")
    next
}
/^! / { print substr($0, 3) > (base() ".code"); close(base() ".code"); next }
{ print > (base() ".expected") }
