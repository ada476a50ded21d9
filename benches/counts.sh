#!/usr/bin/env bash
# Instructions per step, counted by valgrind, as the table of benches/counts.md.
#
#   benches/counts.sh            prints the table
#   benches/counts.sh --write    writes benches/counts.md
#
# Two runs of different length are counted; their difference over the difference in steps leaves out
# reading, starting and ending. Counts do not depend on the load of the machine.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v valgrind > /dev/null || { echo "valgrind is not installed" >&2; exit 2; }
target=${CARGO_TARGET_DIR:-$PWD/target}
work=$target/benches/counts
mkdir -p "$work"
cargo build --release --quiet -p handc
handc=$target/release/handc

# Instructions of a command.
count() {
    valgrind --tool=callgrind --callgrind-out-file="$work/callgrind.out" "$@" 2>&1 |
        sed -n 's/.*Collected : \([0-9]*\).*/\1/p'
}

# Instructions per step between two durations: step (ms), short (s), long (s), command.
per_step() {
    local step=$1 short=$2 long=$3
    shift 3
    local a b
    a=$(count "$@" --duration "$short")
    b=$(count "$@" --duration "$long")
    echo "$step $short $long $a $b" |
        awk '{ printf "%d", ($5 - $4) / (($3 - $2) * 1000 / $1) + 0.5 }'
}

row() {
    local name=$1 file=$2 scenario=$3 step=$4 short=$5 long=$6
    local crate=$work/$name
    "$handc" compile "$file" --out "$crate" > /dev/null 2>&1
    CARGO_TARGET_DIR=$work/target cargo build --release --quiet --manifest-path "$crate/Cargo.toml"
    local runner=$work/target/release/$name
    local alone together read
    alone=$(per_step "$step" "$short" "$long" "$runner" --scenario "$scenario")
    together=$(per_step "$step" "$short" "$long" "$runner" --scenario "$scenario" \
        --instances 8 --threads 1 --spread start=1e-4)
    read=$(per_step "$step" "$short" "$long" "$handc" run "$file" --scenario "$scenario")
    echo "| $name, \`$scenario\` | $alone | $((together / 8)) | $read |"
}

table() {
    echo "# Instructions per step"
    echo
    echo "Counted by valgrind on the machine code for any x86-64 processor; written by \`benches/counts.sh --write\`."
    echo "The ensemble is of 8 copies on one thread; its figure is for one step of one copy."
    echo
    echo "| model | compiled | compiled, in an ensemble | interpreter |"
    echo "|---|---|---|---|"
    row hand tests/fixtures/hand.hdl close 1 0.5 1
    row finger tests/fixtures/finger.hdl track 10 1 3
    row grasp models/grasp.hdl hold 1 0.5 1
    echo
    echo "With $(rustc --version | cut -d' ' -f1,2)."
}

if [ "${1:-}" = --write ]; then
    table > "$work/counts.md"
    mv "$work/counts.md" benches/counts.md
else
    table
fi
