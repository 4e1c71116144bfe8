# tools/test sanitizers sources this: builds all libraries for addresses and undefined behaviour, to be linked with the tests that are compiled in
# build/dev, and what uses threads for races, with its tests (a race is told by what all code does), and runs these and the fuzzers.
step "building for the sanitizers of addresses and undefined behaviour"
cmake --preset asan -DTERACELL_UNITY=ON -DTERACELL_COMPILED_TESTS="$PWD/build/dev" >/dev/null
cmake --build --preset asan --target teracell_tests fuzzers
step "building for the sanitizer of races"
cmake --preset tsan -DTERACELL_UNITY=ON >/dev/null
cmake --build --preset tsan --target thread_tests

fuzz() (
  name=$(basename "$1" _fuzz)
  corpus=$(mktemp -d)
  trap 'rm -rf "$corpus"' EXIT
  "$1" -max_total_time="$FUZZ_SECONDS" -timeout=20 -rss_limit_mb=2048 -print_funcs=0 -print_final_stats=0 -verbosity=0 "$corpus" "tests/fuzz/corpus/$name"
)
# every_third N: the tests of teracell_tests whose numbers leave N when they are divided by 3, without those that are [long]: each took more
# than ten seconds with the sanitizers, together a third of the time; none is about damaged or hostile input, and others go the same ways.
# `set -e` does not reach what is run by whole().
every_third() (
  names=$(mktemp)
  trap 'rm -f "$names"' EXIT
  tests=build/asan/tests/teracell_tests
  $tests '~[long]' --list-test-names-only | awk "NR % 3 == $1" | as_patterns >"$names"
  found=$($tests --input-file "$names" --list-test-names-only | wc -l) expected=$(wc -l <"$names")
  [[ $found -eq $expected && $found -gt 0 ]] || { echo "$tests: expected $expected tests by their names, found $found"; exit 1; }
  $tests --input-file "$names"
)
export -f fuzz every_third as_patterns
export FUZZ_SECONDS=${FUZZ_SECONDS:-10}
step "sanitizers and fuzzers ($FUZZ_SECONDS s each), two at a time"
fuzzers=(build/asan/tests/fuzz/*_fuzz)
two_at_a_time "every_third 0" "every_third 1" "every_third 2" 'build/tsan/tests/thread_tests "[threads]"' "${fuzzers[@]/#/fuzz }"
