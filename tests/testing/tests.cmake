supple_test(testing LABEL unit LINKS supple::testing
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/messages_test.cpp ${CMAKE_CURRENT_LIST_DIR}/own_models_test.cpp)
