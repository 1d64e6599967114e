#!/usr/bin/env bash
# Compares everything that the program prints and writes with what it did at the commit BASE, byte by byte.
# Usage: tests/golden/compare.sh BASE [PATTERN]   PATTERN: a regular expression; only jobs whose names match it run
#   Jobs: NAME.SEED (a shipped protocol: plan, simulation, results, power), NAME.coded (a study of people, blinded and then
#   unblinded), calc.SUBCOMMAND.
# Results of BASE are kept in ${JND_GOLDEN:-${XDG_CACHE_HOME:-~/.cache}/jnd-golden} and used again while this script is the same.
# Exit status: 0 all the same; 1 something differs; 2 wrong usage, or a build failed.
# shellcheck disable=SC2317  # functions that xargs calls
set -euo pipefail
case ${1:-} in -h | --help) sed -n '2,7s/^# //p' "$0"; exit 0 ;; esac
[ $# -eq 1 ] || [ $# -eq 2 ] || { sed -n '2,7s/^# //p' "$0" >&2; exit 2; }
script=$(realpath "$0")
cd "$(dirname "$0")/../.."
source runner/setup.sh
base=$(git rev-parse -q --verify "$1^{commit}") || { echo "$1 is no commit here" >&2; exit 2; }
pattern=${2:-.}
cache=${JND_GOLDEN:-${XDG_CACHE_HOME:-$HOME/.cache}/jnd-golden}
key=$(sha256sum "$script" | cut -c1-12)
old=$cache/$base/$key new=$cache/work/$key
export seeds="1 2" people=3 studies=2 LC_ALL=C.UTF-8 NO_COLOR=1 COLUMNS=80
unset JND_STUDY JND_DATA_DIR

# build FOLDER: the programs of a source tree, in its build/dev.
build() {
  (cd "$1" && set_launcher && cmake --preset dev "${launcher[@]}" && nice cmake --build --preset dev --target jnd real_study) \
    >"$cache/build.log" 2>&1 || { tail -n 20 "$cache/build.log" >&2; echo "cannot build $1" >&2; exit 2; }
}

# keep FILE COMMAND...: FILE gets both streams and the exit status. Progress depends on the machine's speed: it is left out.
keep() {
  local file=$1 status=0
  shift
  mkdir -p "$(dirname "$file")"
  "$@" >"$file" 2>"$file.errors" </dev/null || status=$?
  { echo "--- errors"; sed -E '/^[a-z ]+: [0-9]+ of [0-9]+$/d' "$file.errors"; echo "--- exit $status"; } >>"$file"
  rm "$file.errors"
}

# results STUDY: everything that is told of a study, in this folder. Names are the same in all studies.
results() {
  keep verify "$jnd" verify "$1" --json
  keep status "$jnd" status "$1"
  keep text "$jnd" analyze "$1" --all
  keep text-short "$jnd" analyze "$1"
  keep methods-said "$jnd" analyze "$1" --methods methods.md
  keep json "$jnd" analyze "$1" --models --json
  keep export-said "$jnd" export "$1" --to export
  keep report-said "$jnd" report "$1" --to report.html
}

# of_protocol NAME SEED
of_protocol() {
  keep plan "$jnd" plan "$1" --seed "$2"
  keep plan-json "$jnd" plan "$1" --seed "$2" --participant 2 --json
  keep power "$jnd" plan "$1" --power --studies "$studies" --seed "$2" --threads 1
  keep power-json "$jnd" plan "$1" --power --studies "$studies" --seed "$2" --threads 1 --json
  keep simulate "$jnd" simulate "$1" --participants "$people" --seed "$2" --threads 1 --study s.sqlite
  results s.sqlite
}

# of_people NAME: a study of people that is not finished, blinded and unblinded. The answers come from a test program; they
# do not fit the levels of a procedure, and such a study cannot be unblinded.
# `jnd unblind` notes the time. That time, the head of the events that follows from it, and the hashes of files with
# either are made the same.
of_people() {
  local head
  keep made "$real_study" s.sqlite "$(find "$protocols" -name "$1.json")" 1 real 3 1
  mkdir coded unblinded
  (cd coded && results ../s.sqlite && keep json-short "$jnd" analyze ../s.sqlite --json &&
    keep plan "$jnd" plan --study ../s.sqlite --participant 1)
  keep unblind "$jnd" unblind s.sqlite --reason "a look"
  grep -q '^--- exit 0' unblind || return 0
  (cd unblinded && results ../s.sqlite && keep plan "$jnd" plan --study ../s.sqlite --participant 1)
  head=$(grep -o '"study_head":"[^"]*"' unblinded/verify | cut -d'"' -f4 || true)
  find unblinded -type f -exec sed -i -E "s/${head:-no head}/HEAD/g; s/(unchanged: sha256 )[0-9a-f]{64}/\1SUM/
    s/^[0-9a-f]{64}(  (log.csv|methods.md|sessions.csv))$/SUM\1/; s/[^,]*,unblinded,/TIME,unblinded,/" {} +
}

# table COLUMNS ROW...: the lines of a CSV file.
table() { printf '%s\n' "$@"; }

# answers SEED COLUMNS LEVELS: counts of six people in two conditions; the same ones of the same SEED on every machine.
answers() {
  awk -v s="$1" -v head="$2" -v levels="$3" 'function draw(n) { s = (s * 16807) % 2147483647; return s % n }
    BEGIN { print head; m = split(levels, x, " ")
      for (p = 1; p <= 6; ++p) for (c = 1; c <= 2; ++c) for (i = 1; i <= m; ++i) {
        k = int(12 * i / (m + 1)) + draw(4) + (c == 2 && i > 1) - 2
        printf "P%d,C%d,%s,12,%d\n", p, c, x[i], (k < 0 ? 0 : (k > 12 ? 12 : k)) } }'
}

# trials: single same-different trials of four people, with how sure each answer was.
trials() {
  awk 'function draw(n) { s = (s * 16807) % 2147483647; return s % n }
    BEGIN { s = 11; print "who,cond,stim,said,sure"
      for (p = 1; p <= 4; ++p) for (t = 0; t < 120; ++t) { x = 100 * (t % 4)
        print "P" p ",C" (t % 3 == 0) "," x "," (draw(500) < 80 + x + 10 * p ? "different" : "same") "," 1 + draw(3) } }'
}

# values GROUPS: a value of each of eight people in three conditions; in two groups unless GROUPS is empty.
values() {
  awk -v groups="$1" 'function draw(n) { s = (s * 16807) % 2147483647; return s % n }
    BEGIN { s = 5; print "participant" (groups ? ",group" : "") ",condition,value"
      for (p = 1; p <= 8; ++p) for (c = 1; c <= 3; ++c)
        print "P" p (groups ? (p <= 3 ? ",old" : ",young") : "") ",C" c "," 200 + 30 * c + draw(900) / 10 + (p > 3) * 20 }'
}

inputs() {
  table id,n_diff,hits,n_same,false_alarms P1,48,38,48,12 P2,6,6,6,0 P3,6,0,6,6 P4,6,2,0,0 P5,20,9,20,11 >counts.csv
  table id,n_diff,hits,n_same,false_alarms a,6,5,6,1 b,6,7,6,1 >bad-counts.csv
  table id,n,correct P1,36,25 P2,36,10 P3,36,36 P4,0,0 >right.csv
  table n,correct 12,13 >bad-right.csv
  table id,n_signal,hits,n_noise,false_alarms a,48,38,48,12 b,9,9,9,0 >rates.csv
  table stimulus,response,n A,A,20 A,B,8 A,C,2 B,A,6 B,B,17 B,C,7 C,A,1 C,B,9 C,C,20 >confusion.csv
  table class,category,n noise,1,22 noise,2,15 noise,3,9 noise,4,4 signal,1,5 signal,2,8 signal,3,14 signal,4,23 >ratings.csv
  table delta,category,n 0,1,14 0,2,6 0,3,3 0,4,1 250,1,4 250,2,5 250,3,7 250,4,8 >sureness.csv
  table participant,condition,delta,n_diff,hits,n_same,false_alarms P1,S,400,6,6,6,1 P1,S,300,6,5,6,2 P1,S,200,6,3,6,1 \
    P2,S,400,12,9,12,3 P2,S,200,12,6,12,4 P1,V,400,6,1,6,2 P1,V,200,6,2,6,2 P3,V,300,6,5,6,0 >series.csv
  values "" >within.csv
  values 1 >mixed.csv
  sed -n '1p;/C1/p' mixed.csv | sed 's/,C1//; s/,condition//' >between.csv
  sed '5d' within.csv >bad-within.csv
  table item,x,y A,1,2 A,5,2 A,7,4 A,3,1 A,6,6 B,1,1 B,4,2 B,3,9 >pairs.csv
  table q 0.5 3.5 4.2 >q.csv
  table p 0.05 0.95 0.5 >p.csv
  table x 1 2 5 9 4 4 7 >x.csv
  table x,n,k 600,20,1 700,20,2 800,20,6 850,20,7 900,20,11 950,20,14 1000,20,15 1100,20,18 1200,20,20 >levels.csv
  table group,x,n,k a,600,20,1 a,900,20,9 a,1200,20,19 b,600,20,3 b,900,20,14 b,1200,20,20 c,600,9,8 c,1200,9,1 >groups.csv
  table x,n,k,order 800,20,3,1 900,20,9,1 1000,20,18,-1 900,20,4,-1 1100,20,19,1 >order.csv
  table x,n,k 1,10,5 2,10,11 >bad-levels.csv
  answers 3 participant,condition,delta,n,k "0 200 300 400" >different.csv
  answers 7 participant,condition,x,n,k "600 750 850 950 1050 1200" >which.csv
  table participant,condition,delta,n,k P1,S,0,4,5 >bad-different.csv
  trials >trials.csv
  table response 1 1 0 1 1 1 0 0 1 1 >responses.csv
  table response,x 1,2.5 0,2.2 1,2.4 1,2.3 >quest.csv
  table participant,stimulus,answer P1,200,5 P1,400,9 P1,800,17 P2,200,20 P2,400,45 P2,800,95 >magnitude.csv
  table participant,setting,start P1,532,-1 P1,501,1 P1,470,-1 P1,492,1 P2,515,1 P2,480,-1 P2,498,1 P2,489,-1 >settings.csv
  cat >run.json <<'END'
{"task": "same-different", "levels": [0, 100, 200, 300, 400, 500, 600], "utility": "variance",
 "grid": {"ln_s": [4.5, 5, 5.5, 6, 6.5, 7], "k": [0, 0.5, 1, 1.5], "lapse": [0, 0.04]},
 "prior": {"ln_s": [5.6, 0.7], "k": [0.75, 0.75], "lapse": [0.7, 0.3]}, "slots": "DSDDS", "responses": [1, 0, 1, 0]}
END
  printf '\xff\xfe\x00' >odd.csv
}

# Arguments of `jnd calc`, a line per call.
calls() {
  local theirs="trials.csv --trials --participant who --condition cond --level stim --answer said --positive different"
  local rule="--start 400 --up 1 --step-up 40 --step-down 40"
  cat <<END
sdt counts.csv
sdt bad-counts.csv
sdt odd.csv
sdt missing.csv
sdt $theirs
coverage --trials 6,12
mafc right.csv --alternatives 3
mafc right.csv --alternatives 5
oddity right.csv
oddity bad-right.csv
duo-trio right.csv
abx right.csv --strategy differencing
abx right.csv --strategy independent
abx rates.csv --rates
reminder rates.csv --intervals 1
reminder rates.csv --intervals 2
identify confusion.csv
identify confusion.csv --classes C,B,A
ratings ratings.csv
sureness sureness.csv
jnd series.csv --reference 900
jnd series.csv --reference 900 --correction half --bootstrap 200
jnd $theirs --reference 900
compare within.csv
compare mixed.csv
compare between.csv
compare bad-within.csv
wilcoxon pairs.csv
ptukey q.csv --groups 3 --df 12
qtukey p.csv --groups 3 --df inf
shapiro x.csv
fit levels.csv --function gaussian --guess 0 --lapse 0.02
fit levels.csv --function weibull --guess 0 --lapse free --estimator map
fit groups.csv --function logistic --guess 0 --lapse 0 --compare --interval bootstrap --replicates 200
fit bad-levels.csv --function gaussian --guess 0 --lapse 0
which levels.csv --standard 900
which groups.csv --standard 900 --link logit
which order.csv --standard 900
hierarchical different.csv --task same-different
hierarchical different.csv --task same-different --people --bootstrap 9 --threads 1
hierarchical different.csv --task same-different --check --observer differencing
hierarchical different.csv --task same-different --overdispersion --lapse shared
hierarchical which.csv --task which --standard 900 --people
hierarchical which.csv --task which --standard 900 --one-jnd
hierarchical $theirs --task same-different --drift
hierarchical $theirs --task same-different --sureness sure
hierarchical bad-different.csv --task same-different
hierarchical which.csv --task which
staircase responses.csv $rule --down 2
staircase responses.csv --start 400 --up 1 --down 1 --step-up 360 --step-down 40 --accelerated
quest quest.csv --t-guess 2.5 --t-guess-sd 0.5
magnitude magnitude.csv
adjust settings.csv --standard 500
posterior run.json
selftest
END
}

# of_calc SUBCOMMAND: each of its calls as text and as JSON.
of_calc() {
  local line words number=0
  inputs
  while read -r line; do
    read -ra words <<<"$line"
    [ "${words[0]}" = "$1" ] || continue
    number=$((number + 1))
    keep "calc-$number" "$jnd" calc "${words[@]}"
    keep "calc-$number-json" "$jnd" calc "${words[@]}" --json
    sed -i "1i \$ jnd calc $line" "calc-$number" "calc-$number-json"
  done < <(calls)
  rm ./*.csv run.json
}

# job FOLDER NAME: does one job beside FOLDER and moves it there when it is whole.
job() {
  local folder=$1/$2 began=$SECONDS
  rm -rf "$folder" "$folder.part"
  mkdir -p "$folder.part"
  cd "$folder.part"
  case $2 in
    calc.*) of_calc "${2#calc.}" ;;
    *.coded) of_people "${2%.coded}" ;;
    *) of_protocol "${2%.*}" "${2##*.}" ;;
  esac
  rm -f ./*.sqlite*
  mv "$folder.part" "$folder"
  echo "$((SECONDS - began)) $2" >>"$1.seconds"
}
export -f keep results of_protocol of_people table answers trials values inputs calls of_calc job

# run FOLDER SOURCE: all jobs that match and that FOLDER does not have yet.
run() {
  local folder=$1 began=$SECONDS name seed
  export jnd=$2/build/dev/runner/jnd real_study=$2/build/dev/tests/real_study protocols=$2/protocols
  mkdir -p "$folder"
  {
    calls | cut -d' ' -f1 | tac | uniq | sed 's/^/calc./'  # the longest first
    "$jnd" new --list --json | grep -o '"name":"[^"]*"' | cut -d'"' -f4 | while read -r name; do
      for seed in $seeds coded; do echo "$name.$seed"; done
    done
  } | { grep -E -- "$pattern" || true; } >"$folder.jobs"
  [ -s "$folder.jobs" ] || { echo "no job matches $pattern" >&2; exit 2; }
  while read -r name; do [ -d "$folder/$name" ] || echo "$name"; done <"$folder.jobs" |
    xargs -r -P "$(nproc)" -I{} nice bash -c 'set -euo pipefail; job "$@"' job "$folder" {}
  echo "$folder: $(wc -l <"$folder.jobs") jobs in $((SECONDS - began)) s"
}

# sums FOLDER: the files of its jobs with their hashes.
sums() { (cd "$1" && xargs -d '\n' -I{} find {} -type f <"$1.jobs" | sort | xargs -d '\n' sha256sum); }

mkdir -p "$cache/work"
exec 9>"$cache/lock"
flock 9
source_of_base=$cache/$base/source
if [ ! -d "$source_of_base" ]; then
  rm -rf "$source_of_base.part"
  mkdir -p "$source_of_base.part"
  git archive "$base" | tar -x -C "$source_of_base.part"
  mv "$source_of_base.part" "$source_of_base"
fi
build "$source_of_base"
build "$PWD"
rm -rf "$cache/work"/*
run "$old" "$source_of_base"
run "$new" "$PWD"

sums "$old" >"$new.sums-base"
sums "$new" >"$new.sums"
differing=$(sort "$new.sums-base" "$new.sums" | uniq -u | cut -c67- | sort -u)
echo "$(cut -c67- "$new.sums-base" "$new.sums" | sort -u | wc -l) files compared, $(grep -c . <<<"$differing" || true) differ"
[ -n "$differing" ] || exit 0
while read -r file; do
  kind=${file#*/}
  [[ $file == calc.* ]] && kind=calc
  printf '%s\t%s\t%s\n' "$kind" "$(diff -aN "$old/$file" "$new/$file" | grep -ac '^[<>]')" "$file"
done <<<"$differing" | sort -s -t $'\t' -k 1,1 | awk -F '\t' '
  function told() { if (files) printf "%s: %d files, %d lines\n%s", kind, files, lines, text; files = lines = 0; text = "" }
  $1 != kind { told(); kind = $1 }
  { ++files; lines += $2; text = text sprintf("  %6d  %s\n", $2, $3) }
  END { told() }'
echo "diff -ru $old $new"
exit 1
