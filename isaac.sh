#!/usr/bin/env bash
# Runs trundle with Isaac Sim's own Python and --backend isaac:
#
#   ./isaac.sh run scenario.yaml            drive in Isaac Sim
#   ./isaac.sh doctor                       check this machine, point by point
#   ./isaac.sh install [WHEEL]              only install trundle there (done by itself on first use)
#
# Isaac Sim is looked for in ISAACSIM_PATH, then as a pip package of the active environment, then in the usual folders,
# then as a pip package of python3.
set -euo pipefail

# Where this file is, and not a link to it.
script=$(readlink -f "${BASH_SOURCE[0]}")
here=$(dirname "$script")

usage() {
  sed -n '2,9s/^# \{0,1\}//p' "$script"
  echo
  echo "Everything after the verb goes to trundle: see ./isaac.sh VERB --help."
}

fail() {
  printf 'isaac.sh: %s\n' "$1" >&2
  exit 2
}

# The launcher of a folder of Isaac Sim, or of its sources where they were built.
python_of_folder() {
  local launcher
  for launcher in "$1"/python.sh "$1"/_build/linux-*/release/python.sh; do
    if [ -f "$launcher" ] && [ -x "$launcher" ]; then
      printf '%s\n' "$launcher"
      return
    fi
  done
  return 1
}

# A folder called isaacsim where we are is found too, and has no loader.
has_isaacsim() {
  "$1" -c 'from importlib.util import find_spec
raise SystemExit(getattr(find_spec("isaacsim"), "loader", None) is None)' >/dev/null 2>&1
}

# The first of some Pythons that there is and that has Isaac Sim.
python_of_pip() {
  local name
  for name in "$@"; do
    if [ -n "$name" ] && command -v "$name" >/dev/null && has_isaacsim "$name"; then
      command -v "$name"
      return
    fi
  done
  return 1
}

find_python() {
  local folder home=${HOME:-}
  if [ -n "${ISAACSIM_PATH:-}" ]; then
    if python_of_folder "$ISAACSIM_PATH"; then return; fi
    if [ -f "$ISAACSIM_PATH/python.sh" ]; then
      fail "ISAACSIM_PATH is $ISAACSIM_PATH, and its python.sh may not be executed: chmod +x it"
    fi
    fail "ISAACSIM_PATH is $ISAACSIM_PATH, and there is no python.sh in it: point it at the folder of Isaac Sim"
  fi
  # ISAAC_PATH is Isaac Sim's own: where it was installed by pip, it names a folder without python.sh.
  if [ -n "${ISAAC_PATH:-}" ] && python_of_folder "$ISAAC_PATH"; then return; fi
  if python_of_pip "${VIRTUAL_ENV:+$VIRTUAL_ENV/bin/python}" "${CONDA_PREFIX:+$CONDA_PREFIX/bin/python}"; then return; fi
  for folder in ${home:+"$home/isaacsim" "$home/isaac-sim"} /isaac-sim /opt/isaacsim /opt/isaac-sim \
    ${home:+"$home"/.local/share/ov/pkg/isaac-sim-*}; do
    if python_of_folder "$folder"; then return; fi
  done
  if python_of_pip python3 python; then return; fi
  fail "no Isaac Sim found. Set ISAACSIM_PATH to its folder (the one with python.sh), or activate the Python where you
installed it: pip install 'isaacsim[all,extscache]'"
}

takes_backend() {
  case "$1" in
    view | joints | drive | plan | run | doctor) return 0 ;;
    *) return 1 ;;
  esac
}

main() {
  case "${1:-}" in
    "" | -h | --help | help)
      usage
      return
      ;;
  esac
  local python
  python=$(find_python)
  if [ "$1" = install ]; then
    exec "$python" "$here/scripts/isaac_install.py" "${2:-$here}"
  fi
  "$python" "$here/scripts/isaac_install.py" --if-missing "$here"
  local verb=$1
  shift
  local argument
  for argument in "$@"; do
    case "$argument" in --backend | --backend=*) exec "$python" -m trundle "$verb" "$@" ;; esac
  done
  if takes_backend "$verb"; then set -- "$@" --backend isaac; fi
  exec "$python" -m trundle "$verb" "$@"
}

main "$@"
