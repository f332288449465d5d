#!/bin/sh
# Makes the pictures of docs/editor.md with the command: figures 5, 6 and 7 of Hahmann, Bonneau and Sauvage,
# "Déformation de courbes multirésolution sous contraintes" (2005), on curves of our own, and fractal curves.
# Run it where the README is; BCIFS names the command (build/bcifs).
set -eu
bcifs=${BCIFS:-build/bcifs}
out=${1:-docs/figures}

edit() { # NAME FILE OPTION …
    name=$1
    shift
    "$bcifs" edit "$@" --quiet --width 600 -o "$out/$name.svg"
}

small=docs/figures/outline32.bcifs
large=docs/figures/outline128.bcifs

# Figure 5: n = 5, L = 3, the role of alpha.
edit figure5-alpha1 "$small" --coarsen 2 --depth 3 --move 1:7,5 --free all --alpha 1
edit figure5-alpha100 "$small" --coarsen 2 --depth 3 --move 1:7,5 --free all --alpha 100

# Figure 6: n = 7, L = 4, one, two and five neighbors answer.
for neighbors in 1 2 5; do
    edit "figure6-near$neighbors" "$large" --coarsen 3 --depth 2 --move 2:5,5 --free "near:$neighbors"
done

# Figure 7: n = 7, L = 2, the two neighbors answer, the details stay.
edit figure7 "$large" --coarsen 5 --depth 2 --move 0:6,3 --free near:1

# Fractal curves.
edit takagi automata/takagi.bcifs --figure cloud --depth 7 --move 4:5,6
edit koch automata/koch.bcifs --depth 4 --move 1:-3/10,1/10
edit spiral automata/spiral.bcifs --depth 6 --move 1:8,3
