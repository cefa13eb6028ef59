#!/usr/bin/env bash
# Makes the pictures of docs/gallery.md again, all of them or those named: docs/gallery.sh [NAME…]
# BRAKEWAVE is the program: target/release/brakewave unless given.
set -euo pipefail
root="$(cd "$(dirname "$0")/.." && pwd)"
brakewave="${BRAKEWAVE:-$root/target/release/brakewave}"
work="$(mktemp -d)"
trap 'rm -r "$work"' EXIT
cd "$work"
ln -s "$root/problems" problems
named=("$@")

# picture NAME FILE ARGUMENTS…: the file of the result folder that a command writes
picture() {
  local name="$1" file="$2"
  shift 2
  if [ ${#named[@]} -gt 0 ] && [[ ! " ${named[*]} " = *" $name "* ]]; then return; fi
  echo "$name: brakewave $*"
  "$brakewave" "$@" --out "$name" >"$name.log" 2>&1 || { cat "$name.log" >&2; exit 1; }
  cp "$name/$file" "$root/docs/gallery/$name.${file##*.}"
}

picture gear_rattle diagram.svg run problems/gear_rattle.ron
picture impact_phase phase_x_v.svg run problems/impact_oscillator.ron
picture two_blocks phase_x1_v1.svg run problems/two_blocks.ron
picture relay phase_x_y.svg run problems/relay.ron
picture threshold diagram.svg run problems/threshold.ron
# the next file stands in a page, and begins at a point of the run above
sed -n '/^```ron cycle.ron/,/^```$/p' "$root/docs/filippov.md" | sed '1d;$d' >cycle.ron
"$brakewave" run problems/threshold.ron >threshold.log 2>&1
picture sliding_cycle phase_x_y.svg run cycle.ron
picture scan scan.svg scan problems/impact_scan.ron
picture impact_map map.svg map problems/impact_scan.ron
picture basins map.svg map problems/impact_basin.ron
picture doubling_curve curve.svg curve problems/ball_curve.ron
picture brake_wave diagram.svg run problems/mode4_stability.ron
picture pressure pressure.svg run problems/mode4_mismatch.ron
picture take_off_curve curve.svg curve problems/mode4_curve.ron
picture cusp curve.svg curve problems/mode2_cusp.ron
picture map map.svg map problems/mode4_map.ron
picture steady steady.svg steady problems/mode4_mismatch.ron --at mass_damping=0.05 --at stiffness_damping=0.003
picture irregular_wave velocity.svg simulate problems/ring_mode4_circle.ron
picture ring_separation space_time.svg simulate problems/ring_material_separation.ron
picture accuracy accuracy.svg accuracy problems/mode4_mismatch.ron
