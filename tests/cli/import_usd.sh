#!/usr/bin/env bash
# A stage of OpenUSD in place of a scene: what the program asks `abbe-usd` for, what it makes of its report, and what it says
# where there is none. With a stand-in for it, and with the real one where a Python is given that has usd-core.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
python=${3:-}
package=$(cd "$bad/../../../python/src" && pwd)

cat >shot.usda <<'USD'
#usda 1.0
(
    upAxis = "Y"
    metersPerUnit = 1
    endTimeCode = 24
    startTimeCode = 0
)
def Xform "World"
{
    def Camera "far" {
        double3 xformOp:translate = (0, 0, 9)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Camera "near" {
        double3 xformOp:translate = (0, 0, 4)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Sphere "ball" {
        double radius = 1
        color3f[] primvars:displayColor = [(0.8, 0.2, 0.2)]
        double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 24: (1, 0, 0) }
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def NurbsPatch "sheet" {
    }
}
USD

# Without the command: what to install.
export ABBE_USD=/nowhere/abbe-usd
expect 1 render shot.usda -o shot.exr
tells err E0803 "/nowhere/abbe-usd"
says err 'pip install "abbe[usd]"'

# A stand-in, which says how it was called and whose scene, report and end are files.
cat >abbe-usd <<'SH'
#!/usr/bin/env bash
printf '%s\n' "$@" >called
while [[ $1 != -- ]]; do [[ $1 != -o ]] || to=$2; shift; done
[[ ! -e made.scene ]] || cp made.scene "$to"
cat report
cat says >&2
exit "$(<end)"
SH
chmod +x abbe-usd
export ABBE_USD=$PWD/abbe-usd
cat >made.scene <<'KDL'
scene 1
camera "World/near" { from 0 0 4; look-at 0 0 0 }
camera "World/far" { from 0 0 9; look-at 0 0 0 }
film { size 24 16 }
light sky { luminance 20000 nits }
shape sphere { radius 1 }
KDL
: >says
echo 0 >end
cat >report <<JSON
{"remarks": [{"code": "W0801", "path": "/World/sheet", "layer": "shot.usda", "file": "$PWD/shot.usda",
              "what": "a shape of type NurbsPatch", "why": "meshes are read"},
             {"code": "W0802", "path": "", "layer": "", "file": "", "what": "all of it", "why": "by less"}],
 "repeated": [{"code": "W0801", "what": "a shape of type NurbsPatch", "why": "meshes are read", "times": 12}]}
JSON
expect 0 render shot.usda --camera World/near --samples 2 --quiet -o near.exr
tells err W0801 "a shape of type NurbsPatch is left out: meshes are read"
says err "shot.usda:24:"
tells err W0802 "all of it is approximated: by less"
tells err W0801 "7 more of these"
says called "--camera"
says called "World/near"
says_not called "--frame"
expect 0 render shot.usda --samples 2 --quiet -o far.exr
says_not called "--camera"
expect 0 render shot.usda --frames 3-4 --samples 2 --quiet -o moving.####.exr
says called "--frames=4-4"
says_not err W0698 # each frame is imported by itself
expect 0 import shot.usda --frame 7 --camera /World/far -o still.scene
says called "--frame=7"
expect 0 check shot.usda
expect 0 info shot.usda
# Packages are archives as packs of scenes are.
printf 'PK\003\004' >shot.usdz
expect 0 check shot.usdz
says called "shot.usdz"

# Its errors stand at the prim; one that ends otherwise is shown with its last words.
sed -i 's/W0801/E0802/' report
expect 1 render shot.usda -o shot.exr
tells err E0802 "a shape of type NurbsPatch"
echo "no json" >report
echo 70 >end
printf 'Traceback\n\nValueError: no such thing\n' >says
expect 1 check shot.usda
tells err E0803 "ended with 70"
says err "ValueError: no such thing"
rm made.scene
echo '{"remarks": [], "repeated": []}' >report
expect 1 check shot.usda
tells err E0803 "made no scene"

# The real one.
"$python" -c 'import numpy; from pxr import Usd' 2>/dev/null || { echo "without usd-core"; finish; }
printf '#!/usr/bin/env bash\nPYTHONPATH=%q exec %q -m abbe.usd.command "$@"\n' "$package" "$python" >abbe-usd
expect 0 render shot.usda --camera World/near --size 24x16 --samples 4 --quiet -o one.exr
says err "shot.usda:24:"
expect 0 import shot.usda --camera World/near -o kept.scene
expect 0 render kept.scene --size 24x16 --samples 4 --quiet -o two.exr
same_pixels one.exr two.exr
expect 0 render shot.usda --camera World/near --size 24x16 --samples 4 --quiet --frames 0,24 -o real.####.exr
[[ $(pixels real.0000.exr) != $(pixels real.0024.exr) ]] || fault "nothing moves"
expect 0 info shot.usda
expect 1 render shot.usda --camera World/neer -o none.exr
tells err E0802 "there is no camera \`World/neer\`"
sed 's/def Sphere "ball" {/&\n        rel none/; s/double radius = 1/double radius = nan/' shot.usda >bad.usda
expect 1 check bad.usda
tells err E0802 "radius"
says err "bad.usda:18:"
echo nothing >broken.usda
expect 1 check broken.usda
tells err E0801 broken.usda
finish
