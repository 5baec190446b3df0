// OpenGL without a display or a window.
#ifndef MJCF_PDG_APPS_PICTURE_EGL_CONTEXT_H_
#define MJCF_PDG_APPS_PICTURE_EGL_CONTEXT_H_

namespace mjcf_pdg::app {

// An OpenGL context without a surface, current in this thread while the object lives. One at a
// time.
class EglContext {
 public:
  EglContext();  // Throws std::runtime_error with a one-line reason.
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

 private:
  void* display_;            // EGLDisplay
  void* context_ = nullptr;  // EGLContext
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_EGL_CONTEXT_H_
