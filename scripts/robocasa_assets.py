"""Write RoboCasa's asset pack of primitive shapes: scripts/robocasa_assets.py FOLDER. RoboCasa has to be installed."""

import sys
from pathlib import Path

from symskill_pddl.errors import SymSkillError
from symskill_pddl.robocasa.assets import write_pack

if len(sys.argv) != 2:
    sys.exit("usage: robocasa_assets.py FOLDER")
try:
    size = write_pack(Path(sys.argv[1]))
except SymSkillError as error:
    print(error, file=sys.stderr)
    sys.exit(error.exit_status)
except OSError as error:
    print(f"cannot write '{sys.argv[1]}': {error}", file=sys.stderr)
    sys.exit(2)
print(f"{sys.argv[1]}: {size / 1000:.0f} kB of models and colours; ROBOCASA_ASSETS_PATH may point there")
