#!/bin/sh
# A renderer for the tests of methods with a command: toy_renderer.sh MODE GIBENCH SCENE SPP SEED OUT
# MODE says how it behaves: right, dark, slow, fails, crashes, hangs, leaves, escapes, nan, small or nothing.
mode=$1 gibench=$2 scene=$3 spp=$4 seed=$5 out=$6

render() {
    "$gibench" render "$scene" --method "path spp=$spp" --seed "$seed" --threads 1 -o "$1" >/dev/null
}

# Writes a black square of $1 x $1 pixels as a PFM file, whose values have the bytes $2.
square() {
    printf 'PF\n%d %d\n-1.0\n' "$1" "$1"
    i=0
    while [ $i -lt $(($1 * $1 * 3)) ]; do
        printf "$2"
        i=$((i + 1))
    done
}

case $mode in
right) render "$out" ;;
dark)
    render "$out-bright.exr"
    oiiotool "$out-bright.exr" --mulc 0.98 -o "$out"
    ;;
slow)
    dd if=/dev/zero of=/dev/null bs=128M count=1
    sleep 0.5
    render "$out"
    ;;
fails)
    echo "reading the scene" >&2
    echo "the lamp is broken" >&2
    exit 3
    ;;
crashes) kill -SEGV $$ ;;
hangs) sleep 1000 ;;
# Both leave a process in a session of its own, which has written its number to a file.
leaves)
    setsid -f sh -c 'echo $$ >left.pid; exec sleep 1000'
    until [ -s left.pid ]; do sleep 0.1; done
    render "$out"
    ;;
escapes) setsid -w sh -c 'sh -c "echo \$\$ >escaped.pid; exec sleep 1000"; true' ;;
nan) square 8 '\000\000\300\177' >"$out" ;;
small) square 4 '\000\000\000\000' >"$out" ;;
nothing) ;;
*) exit 2 ;;
esac
