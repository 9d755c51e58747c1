# match.awk EXPECTED OUTPUT - exit 0 if the output is as expected, with "..." as wildcard
FILENAME == ARGV[1] { expected[++n_expected] = $0; next }
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
function fits(i, j) {
    for (; i <= n_expected; i++) {
        if (expected[i] == "...") {
            for (; j <= n_found + 1; j++)
                if (fits(i + 1, j))
                    return 1
            return 0
        }
        if (j > n_found || !line_fits(expected[i], found[j]))
            return 0
        j++
    }
    return j > n_found
}
END { exit !fits(1, 1) }
