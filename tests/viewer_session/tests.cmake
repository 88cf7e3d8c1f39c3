supple_test(viewer_session LABEL unit LINKS supple::viewer supple::io
  SOURCES viewer_session/edit_session_test.cpp viewer_session/simulation_session_test.cpp
          viewer_session/view_session_test.cpp)
