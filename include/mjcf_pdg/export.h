// The macros that mark what the shared library exports. Everything else in it is hidden.
#ifndef MJCF_PDG_EXPORT_H_
#define MJCF_PDG_EXPORT_H_

// MJCF_PDG_API exports a class or function; MJCF_PDG_LOCAL hides a member of an exported class. The
// CMake target of the static library defines MJCF_PDG_STATIC, so that a program or plugin that is
// linked with it does not export it in turn.
#if defined(MJCF_PDG_STATIC) || !defined(__GNUC__)
#define MJCF_PDG_API
#define MJCF_PDG_LOCAL
#else
#define MJCF_PDG_API __attribute__((visibility("default")))
#define MJCF_PDG_LOCAL __attribute__((visibility("hidden")))
#endif

#endif  // MJCF_PDG_EXPORT_H_
