# Sourced by tests/run.sh and .ci/run: measures the steps of a script.
steps=() step_began=$SECONDS step_used=0

# step [NAME]: ends the step before, and begins the next.
step() {
  local clock used
  clock=$(mktemp)
  times >"$clock"  # not in $(...): a subshell has no children yet
  used=$(awk -F'[ms ]+' 'NR == 2 { printf "%.0f", $1 * 60 + $2 + $3 * 60 + $4 }' "$clock")
  rm -f "$clock"
  [ ${#steps[@]} -eq 0 ] || steps[-1]+=$'\t'$((SECONDS - step_began))$'\t'$((used - step_used))
  step_began=$SECONDS step_used=$used
  [ $# -eq 0 ] || steps+=("$1")
}

# print_steps: each step that has ended, with its wall time and what its programs used of the processors, s.
print_steps() {
  printf '%s\n' "${steps[@]}" | awk -F'\t' 'BEGIN { printf "  %-48s %8s %12s\n", "step", "wall, s", "processor, s" }
    { printf "  %-48s %8d %12d\n", $1, $2, $3; wall += $2; used += $3 }
    END { printf "  %-48s %8d %12d\n", "all of it", wall, used }'
}

# slowest_tests LOG...: the ten slowest tests of logs of ctest, named BUILD/TEST; s.
slowest_tests() {
  local log
  for log in "$@"; do
    sed -nE 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([a-z_0-9]+) .* ([0-9.]+) sec.*$/\2 \1/p' "$log" |
      sed "s|\$| $(basename "$(dirname "$log")")|"
  done | sort -rn | head -n 10 | awk '{ printf "  %-48s %8.1f\n", $3 "/" $2, $1 }'
}
