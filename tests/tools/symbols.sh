#!/bin/sh
# What decides the state may call no function of libm but sqrt and its exact kin: the others
# differ between machines in the last bit. And a module exports one symbol.
allowed='sqrt|fabs|fmin|fmax|ceil|floor|trunc|rint|fma|fmod'
known='acos|acosh|asin|asinh|atan|atan2|atanh|cbrt|cos|cosh|erf|erfc|exp|exp2|exp10|expm1|hypot|lgamma|log|log10|log1p|log2|pow|sin|sincos|sinh|tan|tanh|tgamma'
failed=0
passed=0
for file in "$@"; do
    found=$(nm -u "$file" 2>/dev/null | awk '{ sub("@.*", "", $NF); print $NF }' | grep -xE "($known)f?l?" | sort -u)
    if [ -n "$found" ]; then
        echo "$file calls" $found "(allowed: $allowed)"
        failed=$((failed + 1))
    else
        passed=$((passed + 1))
    fi
    case $file in
    *.so)
        exported=$(nm -D --defined-only "$file" | awk '{ print $NF }')
        if [ "$exported" = clothsim_module ]; then passed=$((passed + 1)); else
            echo "$file exports" $exported ", expected clothsim_module only"
            failed=$((failed + 1))
        fi
        ;;
    esac
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
