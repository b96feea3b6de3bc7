#!/usr/bin/env bash
# Make domains/kitchen and problems/kitchen from the shipped demonstrations, by the commands a user would type;
# in every dialect: strips at the top, the others in folders of their own.
# Usage: scripts/make_examples.sh [FOLDER]     (default: the repository)
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
to="${1:-$root}"
symskill="${SYMSKILL:-$root/.venv/bin/symskill}"

library="$(mktemp -d)"
trap 'rm -rf "$library"' EXIT
mkdir -p "$to/domains/kitchen" "$to/problems/kitchen"

"$symskill" learn "$root"/symskill_pddl/data/kitchen/*.hdf5 -o "$library/kitchen"
"$symskill" export "$library/kitchen" --name kitchen --dialect all -o "$to/domains/kitchen"
while read -r file task seed; do
    "$symskill" problem "$library/kitchen" --name kitchen --dialect all --task "$task" --seed "$seed" -o "$to/problems/kitchen/$file.pddl"
done <<'EOF'
open-door OpenSingleDoor 0
close-door CloseSingleDoor 0
cabinet-to-counter PnPCabToCounter 0
counter-to-cabinet PnPCounterToCab 0
stove-to-counter PnPStoveToCounter 0
counter-to-stove PnPCounterToStove 0
open-drawer OpenDrawer 0
close-drawer CloseDrawer 0
turn-on-stove TurnOnStove 0
turn-off-stove TurnOffStove 0
turn-on-faucet TurnOnSinkFaucet 0
turn-off-faucet TurnOffSinkFaucet 0
store-cheese StoreCheese 0
put-cheese-away PutCheeseAway 0
make-breakfast MakeBreakfast 0
cook-dinner CookDinner 0
EOF

# the README shows the domain's pick from the cabinet
"$(dirname "$symskill")/python" - "$root/README.md" "$to" <<'EOF'
import re
import sys
from pathlib import Path

readme, to = Path(sys.argv[1]), Path(sys.argv[2])
domain = (to / "domains" / "kitchen" / "domain.pddl").read_text()
block = next(b for b in domain.split("\n\n") if "(:action pick-food-from-cabinet" in b)
predicate = re.search(r"(?:    ;.*\n)+    \(food-in-cabinet .*\n", domain)
example = "\n".join(line[2:] for line in f"{predicate[0] if predicate else ''}\n{block}".splitlines()).rstrip()
text = re.sub(r"(?s)```pddl\n.*?```", lambda _: f"```pddl\n{example}\n```", readme.read_text(), count=1)
(to / "README.md").write_text(text)
EOF
