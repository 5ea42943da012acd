#!/usr/bin/env bash
# Runs trundle with Isaac Sim's own Python and --backend isaac:
#
#   ./isaac.sh run scenario.yaml            drive in Isaac Sim
#   ./isaac.sh doctor                       check this machine, point by point
#   ./isaac.sh install [WHEEL]              only install trundle there (done by itself on first use)
#
# Isaac Sim is looked for in ISAACSIM_PATH, then in the usual folders, then as a pip package of the active Python.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

usage() {
  sed -n '2,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
  echo
  echo "Everything after the verb goes to trundle: see ./isaac.sh VERB --help."
}

fail() {
  printf 'isaac.sh: %s\n' "$1" >&2
  exit 2
}

# The folder's launcher; a folder that somebody named must have one.
python_of_folder() {
  if [ -x "$1/python.sh" ]; then
    printf '%s\n' "$1/python.sh"
  elif [ -x "$1/_build/linux-x86_64/release/python.sh" ]; then
    printf '%s\n' "$1/_build/linux-x86_64/release/python.sh"
  else
    return 1
  fi
}

has_isaacsim() {
  "$1" -c 'import importlib.util, sys; sys.exit(importlib.util.find_spec("isaacsim") is None)' >/dev/null 2>&1
}

find_python() {
  local folder name
  for name in ISAACSIM_PATH ISAAC_PATH; do
    folder=${!name:-}
    [ -n "$folder" ] || continue
    python_of_folder "$folder" || fail "$name is $folder, and there is no python.sh in it: point it at the folder of Isaac Sim"
    return
  done
  for folder in "$HOME/isaacsim" "$HOME/isaac-sim" /isaac-sim /opt/isaacsim /opt/isaac-sim "$HOME"/.local/share/ov/pkg/isaac-sim-*; do
    if python_of_folder "$folder"; then return; fi
  done
  for name in "${VIRTUAL_ENV:+$VIRTUAL_ENV/bin/python}" python3 python; do
    if [ -n "$name" ] && command -v "$name" >/dev/null && has_isaacsim "$name"; then
      command -v "$name"
      return
    fi
  done
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
