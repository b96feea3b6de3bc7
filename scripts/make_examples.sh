#!/usr/bin/env bash
# Make domains/{kitchen,play} and problems/{kitchen,play} from the shipped demonstrations, by the commands a user would type;
# in every dialect: the plainest that can say the domain at the top, the others in folders of their own.
# Usage: scripts/make_examples.sh [FOLDER]     (default: the repository)
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
to="${1:-$root}"
symskill="${SYMSKILL:-$root/.venv/bin/symskill}"
python="$(dirname "$symskill")/python"

library="$(mktemp -d)"
trap 'rm -rf "$library"' EXIT
for name in kitchen play; do
    mkdir -p "$to/domains/$name" "$to/problems/$name"
    "$symskill" learn "$root/symskill_pddl/data/$name"/*.hdf5 -o "$library/$name"
    "$symskill" export "$library/$name" --name "$name" --dialect all -o "$to/domains/$name"
done

# `symskill problem` for each line, in one process, so that the simulator is set up once
cat > "$library/problems.py" <<'EOF'
import sys

from symskill_pddl.cli import main

library, to = sys.argv[1:]
for line in sys.stdin:
    name, file, task, seed = line.split()
    output = f"{to}/problems/{name}/{file}.pddl"
    words = ["problem", f"{library}/{name}", "--name", name, "--dialect", "all", "--task", task, "--seed", seed, "-o", output]
    sys.argv = ["symskill", *words]
    try:
        main()
    except SystemExit as ended:
        if ended.code:
            raise
EOF
"$python" "$library/problems.py" "$library" "$to" <<'EOF'
kitchen open-door OpenSingleDoor 0
kitchen close-door CloseSingleDoor 0
kitchen cabinet-to-counter PnPCabToCounter 0
kitchen counter-to-cabinet PnPCounterToCab 0
kitchen stove-to-counter PnPStoveToCounter 0
kitchen counter-to-stove PnPCounterToStove 0
kitchen open-drawer OpenDrawer 0
kitchen close-drawer CloseDrawer 0
kitchen turn-on-stove TurnOnStove 0
kitchen turn-off-stove TurnOffStove 0
kitchen turn-on-faucet TurnOnSinkFaucet 0
kitchen turn-off-faucet TurnOffSinkFaucet 0
kitchen store-cheese StoreCheese 0
kitchen put-cheese-away PutCheeseAway 0
kitchen make-breakfast MakeBreakfast 0
kitchen cook-dinner CookDinner 0
play serve-0 PlayServe 0
play serve-1 PlayServe 1
play serve-2 PlayServe 2
play serve-3 PlayServe 3
play cook-and-cover-0 PlayCookAndCover 0
play cook-and-cover-1 PlayCookAndCover 1
play cook-and-cover-2 PlayCookAndCover 2
play cook-and-cover-3 PlayCookAndCover 3
play swap-0 PlaySwap 0
play swap-1 PlaySwap 1
play swap-2 PlaySwap 2
play swap-3 PlaySwap 3
EOF

# the README shows the domain's pick from the cabinet
"$python" - "$root/README.md" "$to" <<'EOF'
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
