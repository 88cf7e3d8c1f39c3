supple_test(testing LABEL unit LINKS supple::testing
  SOURCES testing/messages_test.cpp testing/own_models_test.cpp)
