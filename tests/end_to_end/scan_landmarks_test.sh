#!/usr/bin/env bash
# Poles and reflectors in a laser's scans, of a simulator that shares no code with Cairn: found, mapped, and where they truly are.
source "$(dirname "$0")/common.sh"

/usr/bin/python3 -c 'import h5py' 2>/dev/null || skip "Debian's python3-h5py is not installed"
make=$CAIRN_SOURCE/tests/end_to_end/make_pole_log.py
/usr/bin/python3 "$make" hall.log
exits 0 cairn import carmen hall.log scans.h5
exits 0 cairn inspect scans.h5
says 'robot/0/laser/intensity'
exits 0 cairn landmarks scans.h5 poles.h5 --poles 0.05..0.5
says '^poles.h5: 1 robot, [0-9]+ controls, [0-9]{4} observations, [0-9]+ range scans$'
exits 0 cairn landmarks scans.h5 reflectors.h5 --reflectors 0.05..0.5
refuses '[0-9]+ observations of landmarks already; --replace leaves them out' cairn landmarks poles.h5 again.h5 --poles 0.05..0.5
exits 0 cairn landmarks poles.h5 again.h5 --poles 0.05..0.5 --replace
same_bits poles.h5 again.h5
refuses 'what is meant is LEAST..MOST in metres' cairn landmarks scans.h5 x.h5 --poles 0.5
refuses 'what to look for' cairn landmarks scans.h5 x.h5
refuses 'is there already' cairn landmarks scans.h5 poles.h5 --poles 0.05..0.5

# The truth has the 13 poles; each is found, nothing else is, and each lies where it is to a few centimetres.
for what in poles reflectors; do
  exits 0 cairn run landmark_map $what.h5 --out map-$what
  cp $what.h5 truth.h5
  /usr/bin/python3 "$make" --truth truth.h5
  exits 0 cairn evaluate map-$what --truth truth.h5
  says '^landmarks.found +13 of 13'
  says '^landmarks.missed +0$'
  says '^landmarks.spurious +0$'
  says '^landmarks.rmse_m +0\.0[0-4]'
  says '^trajectory.rmse_m +0\.0[0-9]'
done
