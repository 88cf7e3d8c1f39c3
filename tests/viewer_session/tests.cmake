supple_test(viewer_session LABEL unit LINKS supple::viewer supple::io
  SOURCES viewer_session/edit_session_test.cpp viewer_session/replay_test.cpp viewer_session/simulation_session_test.cpp
          viewer_session/view_session_test.cpp)
if(TARGET supple_view_server)
  supple_test(viewer_server LABEL unit LINKS supple_view_server Boost::headers
    SOURCES viewer_session/messages_test.cpp viewer_session/view_server_test.cpp viewer_session/web_client.cpp)
endif()
