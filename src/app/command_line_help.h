// What `abbe COMMAND --help` begins with.
#pragma once

namespace abbe {

// All that `abbe` alone says.
inline constexpr const char* kFirstWords = R"(abbe renders scenes written as text by simulating light.

  abbe render room.scene          a picture of a scene: room.exr, and room.png to look at
  abbe check room.scene           everything that is wrong with it, without rendering
  abbe explain                    how scenes are written, with a first one
  abbe explain light              what a word of them means
  abbe convert room.exr room.png  another PNG of it, say --exposure 1

`abbe help` lists all commands, `abbe help render` explains one.
)";

inline constexpr const char* kAbout = R"(A spectral, physically based film renderer.

Examples:
  abbe render room.scene                       the image goes where the scene says, else to room.exr
  abbe room.scene --samples 1024               the same command; room.png is beside room.exr
  abbe check room.scene                        everything that is wrong, without rendering
  abbe explain camera.f-stop                   what a property means; also: explain glass, explain E0310
  abbe info room.exr                           how an image was made)";

inline constexpr const char* kRenderHelp = R"(Renders a scene to an OpenEXR image.

Examples:
  abbe render room.scene -o room.exr
  abbe render room.scene --size 640x360 --samples 64 --png=look.png    another name than room.png; --png off: none
  abbe render room.scene --noise 0.5% --time 45min     ends at whichever comes first
  abbe render prism.scene -D prism-turn='-32.9 deg'    sets a parameter of the scene
  abbe render room.scene --json                        progress as JSON lines on stdout
  abbe render room.scene --resume                      goes on where it was interrupted
  abbe render room.scene --part 2/4                    a quarter of the samples, for `abbe merge`

Ctrl-C writes the image and a checkpoint; a second one leaves at once.)";

inline constexpr const char* kMergeHelp = R"(Puts parts of a render together, to the bits of the whole.

Examples:
  abbe merge room.part*.abbe -o room.exr
  abbe merge left.part1.abbe right.part1.abbe -o room.exr      crops with the same samples)";

inline constexpr const char* kExplainHelp = R"(Explains a scene, a property, a type, a unit or a diagnostic.

Examples:
  abbe explain                                 how scenes are written, and what there is
  abbe explain film                            what a kind takes
  abbe explain room.scene --effects            what it needs simulated and which line asks, and what is not simulated
  abbe explain pool.scene --camera diver       also which light paths a render with these options will take
  abbe explain camera.lens
  abbe explain dielectric
  abbe explain E0310
  abbe explain unit nits)";

inline constexpr const char* kInfoHelp = R"(Tells what is in a scene or in an image.

Examples:
  abbe info room.scene
  abbe info --json room.exr)";

inline constexpr const char* kVolumeHelp = R"(Inspects, makes and converts OpenVDB volumes.

Examples:
  abbe volume info cloud.vdb
  abbe volume make cumulus cloud.vdb --resolution 1000
  abbe volume convert bunny.vdb fog.vdb --fog)";

inline constexpr const char* kHelpHelp =
    R"(Lists all commands, or explains one of them, or a word of the scene language.

Examples:
  abbe help
  abbe help render
  abbe help volume make
  abbe help camera                             the same as `abbe explain camera`)";

} // namespace abbe
