# Sourced by tools/test and what it calls. Stages and their times: TERACELL_TIMES is a file to which a line is added for each stage, its
# seconds and its name; .ci/run prints it as a table.
: "${TERACELL_TIMES:=/dev/stderr}"
export TERACELL_TIMES

# step NAME: ends the stage before it, and begins this one.
step() {
  if [[ ${stage:-} && $TERACELL_TIMES != /dev/stderr ]]; then printf '%d\t%s\n' $((SECONDS - stage_began)) "$stage" >>"$TERACELL_TIMES"; fi
  stage=$1 stage_began=$SECONDS
  printf '\n== %d:%02d %s\n' $((SECONDS / 60)) $((SECONDS % 60)) "$1"
}

# Names of tests, line by line, as patterns of Catch2 that each match that one alone.
as_patterns() { sed 's/[],[\\"*~]/\\&/g'; }

# Runs a command and shows what it said when it is done: two at once must not mix their lines. Of what went well it shows the end.
whole() {
  local said status=0 began=$SECONDS
  said=$("$@" 2>&1 </dev/null) || status=$?
  [[ $TERACELL_TIMES == /dev/stderr ]] || printf '%d\t  %s\n' $((SECONDS - began)) "$*" >>"$TERACELL_TIMES"
  printf '%s: exit status %s, %d s\n%s\n' "$*" "$status" $((SECONDS - began)) "$(tail -n "$([[ $status -eq 0 ]] && echo 4 || echo 300)" <<<"$said")"
  return "$status"
}
export -f whole

# two_at_a_time COMMAND...: each COMMAND is one line of the shell. Fails when one of them has failed, after all have run.
two_at_a_time() { printf '%s\n' "$@" | xargs -P 2 -d '\n' -I{} bash -euc 'SECONDS=0; whole {}'; }
