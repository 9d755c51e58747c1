# match.awk EXPECTED OUTPUT - exit 0 if the output is as expected, with "..." as wildcard; else
# prints the lines that differ: those that are missing after "-", those too many after "+"
FILENAME == ARGV[1] { expected[++n_expected] = $0; next }
# LeakSanitizer on a thread that ends while it looks for leaks
/^==[0-9]+==Unable to get registers from thread/ { next }
{ found[++n_found] = $0 }

function line_fits(pattern, line,    parts, n, i, at) {
    n = split(pattern, parts, /\.\.\./)
    if (n < 2)
        return pattern == line
    if (substr(line, 1, length(parts[1])) != parts[1])
        return 0
    line = substr(line, length(parts[1]) + 1)
    for (i = 2; i < n; i++) {
        at = index(line, parts[i])
        if (!at)
            return 0
        line = substr(line, at + length(parts[i]))
    }
    at = length(line) - length(parts[n])
    return at >= 0 && substr(line, at + 1) == parts[n]
}
# cost[i, j]: the fewest differing lines from the expected line i and the found line j on
function weigh(    i, j, best) {
    for (i = n_expected + 1; i >= 1; i--)
        for (j = n_found + 1; j >= 1; j--) {
            if (i > n_expected)
                best = n_found + 1 - j
            else if (expected[i] == "...") {
                best = cost[i + 1, j]
                if (j <= n_found && cost[i, j + 1] < best)
                    best = cost[i, j + 1]
            } else {
                best = 1 + cost[i + 1, j]
                if (j <= n_found && 1 + cost[i, j + 1] < best)
                    best = 1 + cost[i, j + 1]
                if (j <= n_found && cost[i + 1, j + 1] < best && line_fits(expected[i], found[j]))
                    best = cost[i + 1, j + 1]
            }
            cost[i, j] = best
        }
    return cost[1, 1]
}
# mark LINE: one that differs, of which 40 are enough
function tell(mark, line) {
    if (++told <= 40)
        print mark " " line
}
function differences(    i, j) {
    for (i = j = 1; i <= n_expected || j <= n_found; )
        if (cost[i, j] == 0 && i > n_expected)
            return
        else if (expected[i] == "..." && i <= n_expected) {
            if (cost[i, j] == cost[i + 1, j]) i++; else j++
        } else if (i <= n_expected && j <= n_found && cost[i, j] == cost[i + 1, j + 1] &&
                   line_fits(expected[i], found[j])) {
            i++
            j++
        } else if (i <= n_expected && cost[i, j] == 1 + cost[i + 1, j])
            tell("-", expected[i++])
        else
            tell("+", found[j++])
    if (told > 40)
        print "... " told - 40 " more lines differ"
}
END {
    # a table of all pairs would be too large
    if (n_expected * n_found > 1000000) {
        print "+ " n_found " lines, expected about " n_expected
        exit 1
    }
    if (weigh() == 0)
        exit 0
    differences()
    exit 1
}
