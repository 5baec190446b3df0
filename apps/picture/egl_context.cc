#include "apps/picture/egl_context.h"

#define EGL_NO_X11  // NOLINT(readability-identifier-naming): EGL's own switch.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

// The functions of this machine's libEGL. It is loaded when something is drawn, and not linked, so
// that the program starts where there is none. Throws std::runtime_error there.
class Egl {
 public:
  static const Egl& Get() {
    static const Egl egl;
    return egl;
  }

 private:
  void* const library_ = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);

  template <typename Function>
  Function* Find(const char* name) const {
    void* const function = library_ == nullptr ? nullptr : dlsym(library_, name);
    if (function == nullptr) {
      throw std::runtime_error("cannot render: no libEGL.so.1 (Debian, Ubuntu: install libegl1)");
    }
    return reinterpret_cast<Function*>(function);
  }

 public:
#define MJCF_PDG_EGL(name) decltype(egl##name)* const name = Find<decltype(egl##name)>("egl" #name)
  MJCF_PDG_EGL(GetProcAddress);
  MJCF_PDG_EGL(GetDisplay);
  MJCF_PDG_EGL(Initialize);
  MJCF_PDG_EGL(Terminate);
  MJCF_PDG_EGL(BindAPI);
  MJCF_PDG_EGL(ChooseConfig);
  MJCF_PDG_EGL(CreateContext);
  MJCF_PDG_EGL(DestroyContext);
  MJCF_PDG_EGL(MakeCurrent);
  MJCF_PDG_EGL(ReleaseThread);
#undef MJCF_PDG_EGL
};

// Returns a display without any window system if Mesa offers it, else the default display. Throws
// std::runtime_error if there is none.
EGLDisplay InitializedDisplay() {
  const Egl& egl = Egl::Get();
  const auto get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      egl.GetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_platform_display != nullptr) {
    const EGLDisplay display =
        get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && egl.Initialize(display, nullptr, nullptr)) return display;
  }
  const EGLDisplay display = egl.GetDisplay(EGL_DEFAULT_DISPLAY);
  if (display != EGL_NO_DISPLAY && egl.Initialize(display, nullptr, nullptr)) return display;
  throw std::runtime_error("cannot render: no EGL display (is a driver such as Mesa installed?)");
}

}  // namespace

EglContext::EglContext() : display_(InitializedDisplay()) {
  const Egl& egl = Egl::Get();
  constexpr EGLint kAttributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                    EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint num_configs = 0;
  if (egl.BindAPI(EGL_OPENGL_API) &&
      egl.ChooseConfig(display_, kAttributes, &config, 1, &num_configs) && num_configs > 0) {
    context_ = egl.CreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
    if (egl.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) &&
        context_ != EGL_NO_CONTEXT) {
      return;
    }
  }
  egl.Terminate(display_);
  throw std::runtime_error("cannot render: EGL gives no OpenGL context without a surface");
}

EglContext::~EglContext() {
  const Egl& egl = Egl::Get();
  egl.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  egl.DestroyContext(display_, context_);
  egl.Terminate(display_);
  egl.ReleaseThread();
}

}  // namespace mjcf_pdg::app
