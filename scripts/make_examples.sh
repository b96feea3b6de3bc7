#!/usr/bin/env bash
# Make domains/kitchen and problems/kitchen from the shipped demonstrations, by the commands a user would type.
# Usage: scripts/make_examples.sh [FOLDER]     (default: the repository)
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
to="${1:-$root}"
symskill="${SYMSKILL:-$root/.venv/bin/symskill}"

library="$(mktemp -d)"
trap 'rm -rf "$library"' EXIT
mkdir -p "$to/domains/kitchen" "$to/problems/kitchen"

"$symskill" learn "$root"/symskill_pddl/data/kitchen/*.hdf5 -o "$library/kitchen"
"$symskill" export "$library/kitchen" --name kitchen -o "$to/domains/kitchen"
while read -r file task seed; do
    "$symskill" problem "$library/kitchen" --name kitchen --task "$task" --seed "$seed" -o "$to/problems/kitchen/$file.pddl"
done <<'EOF'
open-door OpenSingleDoor 0
close-door CloseSingleDoor 0
cabinet-to-counter PnPCabToCounter 0
counter-to-cabinet PnPCounterToCab 0
store-cheese StoreCheese 0
EOF
