// What the shared library exports. Everything else in it is hidden.
#ifndef MJCF_PDG_EXPORT_H_
#define MJCF_PDG_EXPORT_H_

// MJCF_PDG_LOCAL hides a part of what is exported. MJCF_PDG_STATIC comes with the CMake target of
// the static library: a program or plugin that has it inside does not export it in turn.
#if defined(MJCF_PDG_STATIC) || !defined(__GNUC__)
#define MJCF_PDG_API
#define MJCF_PDG_LOCAL
#else
#define MJCF_PDG_API __attribute__((visibility("default")))
#define MJCF_PDG_LOCAL __attribute__((visibility("hidden")))
#endif

#endif  // MJCF_PDG_EXPORT_H_
